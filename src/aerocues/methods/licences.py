"""Under which licence the code of a method stands."""

from __future__ import annotations

from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, metadata

from aerocues.errors import ArgumentError
from aerocues.methods.parameters import AEROCUES, OPENCV

PERMISSIVE = ("Apache", "MIT", "BSD", "ISC", "Zlib", "0BSD", "Unlicense", "CC0")
"""Beginnings of the names of licences without duties for the code around them."""
KNOWN = {OPENCV: "Apache-2.0", AEROCUES: "Apache-2.0", "COLMAP": "BSD-3-Clause"}
KINDS = ("permissive",)


def licence_of(origin: str) -> str | None:
    """The licence of OpenCV, COLMAP, or a distribution that brings methods; None if unknown."""
    if origin in KNOWN:
        return KNOWN[origin]
    try:
        found = metadata(origin.partition(" ")[0])
    except (PackageNotFoundError, ValueError):
        return None
    fields = found.json
    named = str(fields.get("license_expression") or fields.get("license") or "")
    classifiers = [
        line.rpartition("::")[2].strip()
        for line in found.get_all("Classifier") or ()
        if line.startswith("License ::")
    ]
    return named.splitlines()[0] if named else ", ".join(classifiers) or None


def is_permissive(licence: str) -> bool:
    """Whether a licence puts no duties on the code around it, by its name."""
    return licence.startswith(PERMISSIVE) or licence.startswith("The Unlicense")


def why_not_licensed(combinations: Iterable[str], kind: str) -> dict[str, str]:
    """Why combinations may not be taken, by their names.

    Parameters
    ----------
    combinations : iterable of str
    kind : {"permissive"}

    Raises
    ------
    ArgumentError
        If there is no such kind of licence.
    """
    from aerocues.methods.plugins import installed_methods

    if kind not in KINDS:
        raise ArgumentError(f"`licence` must be one of {', '.join(KINDS)}, got {kind!r}")
    methods = installed_methods()
    origins = {"COLMAP": "COLMAP"}
    for kind_of_rows in (methods.matchers, methods.descriptors, methods.detectors):
        origins |= {name: row.origin for name, row in kind_of_rows.items()}
    reasons: dict[str, str] = {}
    for name in combinations:
        detector, descriptor, _, matcher = name.split("-")
        for part in (detector, descriptor, matcher):
            licence = licence_of(origins[part]) if part in origins else None
            if licence is None:
                reasons.setdefault(name, f"the licence of {part} is not known")
            elif not is_permissive(licence):
                reasons.setdefault(name, f"the licence of {part} is {licence}")
    return reasons
