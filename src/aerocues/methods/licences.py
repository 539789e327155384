"""Under which licence the code of a method stands."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from importlib.metadata import PackageNotFoundError, metadata
from typing import Any

from aerocues.errors import ArgumentError
from aerocues.methods.combination import Combination
from aerocues.methods.parameters import AEROCUES, OPENCV
from aerocues.methods.registry import Methods

PERMISSIVE = {"apache", "mit", "bsd", "isc", "iscl", "zlib", "0bsd", "unlicense", "cc0"}
"""Names of licences without duties for the code around them."""
BESIDE = {
    *("the", "license", "licence", "software", "version", "v", "and"),
    *("0", "1.0", "2", "2.0", "v2", "v2.0", "3", "clause", "new", "modified", "revised"),
    *("simplified", "expat", "cmu", "libpng", "universal", "public", "domain", "dedication"),
    *("no", "attribution", "with", "llvm", "exception"),
}
"""Words that may stand beside these names and add no duty; all others may."""
EITHER = re.compile(r"\sOR\s", re.IGNORECASE)
CHOICE = re.compile(r"\(([^()]*\sOR\s[^()]*)\)", re.IGNORECASE)
COLMAP = "COLMAP"
PIXELMAP = "pixelmap-python"
KNOWN = {OPENCV: "Apache-2.0", AEROCUES: "Apache-2.0", COLMAP: "BSD-3-Clause", PIXELMAP: "MIT"}
BUILT_ON = {"PIXELMAP": PIXELMAP}
"""What does the work of our own methods where that is another package."""
KINDS = ("permissive",)
LONGEST = 100
"""Letters of a licence's name; what is longer is its text."""


def licence_of(origin: str) -> str | None:
    """The licence of OpenCV, COLMAP, or a distribution that brings methods; None if unknown."""
    if origin in KNOWN:
        return KNOWN[origin]
    try:
        found = metadata(origin.partition(" ")[0])
    except (PackageNotFoundError, ValueError):
        return None
    if expression := found.get_all("License-Expression"):
        return str(expression[0])
    classifiers = [
        line.rpartition("::")[2].strip()
        for line in found.get_all("Classifier") or ()
        if line.startswith("License ::")
    ]
    # "OSI Approved" alone names no licence.
    if named := [each for each in classifiers if not each.lower().endswith("approved")]:
        return ", ".join(named)
    text = "".join(found.get_all("License") or ()).strip()
    return text if text and len(text) <= LONGEST and "\n" not in text else None


def is_permissive(licence: str) -> bool:
    """Whether a licence puts no duties on the code around it, by its name.

    Of licences joined by OR one must be permissive, of others all. Every word must be known: what
    is added to the name of a licence, such as "non-commercial", may be a duty.
    """
    while inner := CHOICE.search(licence):
        told = "MIT" if is_permissive(inner[1]) else "restricted"
        licence = f"{licence[: inner.start()]} {told} {licence[inner.end() :]}"
    alternatives = [set(re.findall(r"[\w.]+", each.lower())) for each in EITHER.split(licence)]
    return any(words & PERMISSIVE and words <= PERMISSIVE | BESIDE for words in alternatives)


def _origins(combination: Combination, methods: Methods) -> list[tuple[str, str | None]]:
    """Names of the detector, descriptor and matcher, and who brings each; None if unknown."""
    parts: list[tuple[str, Mapping[str, Any]]] = [
        (combination.detector, methods.detectors),
        (combination.descriptor, methods.descriptors),
        (combination.matcher, methods.matchers),
    ]
    return [(name, _origin(name, rows)) for name, rows in parts]


def _origin(name: str, rows: Mapping[str, Any]) -> str | None:
    if name not in rows:
        return COLMAP if name == COLMAP else None
    origin = str(rows[name].origin)
    return BUILT_ON.get(name, origin) if origin == AEROCUES else origin


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
    reasons: dict[str, str] = {}
    for name in combinations:
        for part, origin in _origins(Combination.parse(name), methods):
            licence = None if origin is None else licence_of(origin)
            if licence is None:
                reasons.setdefault(name, f"the licence of {part} is not known")
            elif not is_permissive(licence):
                reasons.setdefault(name, f"the licence of {part} is {licence}")
    return reasons
