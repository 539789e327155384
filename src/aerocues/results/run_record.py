"""``run.json``: configuration, versions and machine of the latest run, with a checksum."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import NoneType
from typing import Any

from aerocues.errors import StoreError
from aerocues.json_files import why_unreadable
from aerocues.results.hashing import content_hash
from aerocues.results.whole_files import json_content

CHECKSUM = "checksum"
MEND = "measure the same again with `aerocues.run` to restore it"
TEXT = (str, NoneType)
NUMBER = (int, NoneType)
FACTS = (dict, NoneType)

SHAPE: Mapping[str, Any] = {
    "settings_key?": TEXT,
    "dataset?": {
        "name": str,
        "geometry?": TEXT,
        "images?": NUMBER,
        "pairs?": NUMBER,
        "settings?": dict,
        "source?": FACTS,
    },
    "preset?": str,
    "preset_parts?": FACTS,
    "protocol?": FACTS,
    "features?": TEXT,
    "combinations?": [str],
    "exclusions?": [{"combination": str, "reason": str, "pairs": int}],
    "versions?": dict,
    "machine?": dict,
    "imported?": FACTS,
}
"""The form of a record: types, lists of one form, objects by key (``?``: it may be missing).

Keys that are not named here are those of another version, and may hold anything.
"""


@dataclass(frozen=True)
class Record:
    """What a ``run.json`` holds; ``problem`` says that it was changed after it was written."""

    facts: dict[str, Any]
    problem: str | None
    has_checksum: bool


def record_content(facts: Mapping[str, Any]) -> bytes:
    """The content of ``run.json``."""
    return json_content({**facts, CHECKSUM: content_hash(dict(facts))})


def read_record(file: Path) -> Record:
    """Read ``run.json``.

    Raises
    ------
    StoreError
        If it cannot be read, or is not of the form that it must have.
    """
    try:
        facts = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise StoreError(f"cannot read {file}: {why_unreadable(error)}; {MEND}") from error
    if fault := _fault(facts, SHAPE, ""):
        raise StoreError(f"{file} is damaged: {fault}; {MEND}")
    checksum = facts.pop(CHECKSUM, None)
    changed = checksum is not None and checksum != content_hash(facts)
    problem = "it was changed after it was written" if changed else None
    return Record(facts, problem, has_checksum=checksum is not None)


def _fault(value: Any, shape: Any, name: str) -> str | None:
    """What is wrong with a value, or None."""
    if isinstance(shape, Mapping):
        return _fault_of_object(value, shape, name)
    if isinstance(shape, list):
        if not isinstance(value, list):
            return f"{name} must be a list"
        faults = (_fault(each, shape[0], f"an entry of {name}") for each in value)
        return next(filter(None, faults), None)
    if isinstance(value, bool) or not isinstance(value, shape):
        return f"{name} must not be {json.dumps(value, default=str)[:40]}"
    return None


def _fault_of_object(value: Any, shape: Mapping[str, Any], name: str) -> str | None:
    if not isinstance(value, dict):
        return f"{name or 'it'} must be an object"
    for key, form in shape.items():
        place = f"{name}.{key.rstrip('?')}".lstrip(".")
        if key.rstrip("?") not in value:
            if not key.endswith("?"):
                return f"{place} is missing"
        elif fault := _fault(value[key.rstrip("?")], form, place):
            return fault
    return None
