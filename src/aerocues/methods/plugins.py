"""Methods that other packages bring, found through entry points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from aerocues.methods.combination import METHOD_NAME
from aerocues.methods.declarations import Declaration, read_declaration
from aerocues.methods.descriptors import DescriptorRow
from aerocues.methods.detectors import DetectorRow
from aerocues.methods.matchers import MatcherRow
from aerocues.methods.registry import Methods, opencv_methods

KINDS: Mapping[str, tuple[str, ...]] = {
    "detectors": ("detector",),
    "descriptors": ("descriptor",),
    "extractors": ("detector", "descriptor"),
    "matchers": ("matcher",),
}
"""The kinds of method that a plug-in of each group of entry points is."""


def load_factory(reference: str) -> Any:
    """The object that an entry point ``module:attribute`` names."""
    return EntryPoint(name="", value=reference, group="").load()


@dataclass(frozen=True)
class _PlugIn:
    """An entry point, the name of its method and the distribution that brings it."""

    name: str
    origin: str
    group: str
    entry: EntryPoint


def _plug_ins() -> Iterator[_PlugIn]:
    for group in KINDS:
        for entry in sorted(entry_points(group=f"aerocues.{group}"), key=lambda entry: entry.name):
            origin = f"{entry.dist.name} {entry.dist.version}" if entry.dist else entry.value
            yield _PlugIn(entry.name.upper(), origin, group, entry)


def _detector(plug_in: _PlugIn, declared: Declaration) -> DetectorRow:
    return DetectorRow(
        plug_in.name,
        plug_in.entry.value,
        declared.parameters,
        declared.reference,
        origin=plug_in.origin,
        unavailable=declared.problem,
    )


def _descriptor(plug_in: _PlugIn, declared: Declaration) -> DescriptorRow:
    return DescriptorRow(
        plug_in.name,
        plug_in.entry.value,
        declared.parameters,
        declared.reference,
        declared.dtype,
        only_detectors=(plug_in.name,) if plug_in.group == "extractors" else (),
        origin=plug_in.origin,
        unavailable=declared.problem,
    )


def _matcher(plug_in: _PlugIn, declared: Declaration) -> MatcherRow:
    return MatcherRow(
        plug_in.name,
        declared.title or plug_in.name,
        declared.reference,
        dict.fromkeys(declared.dtypes, declared.parameters),
        declared.dtypes or {"L2": ("float32",), "HAM": ("uint8",)},
        factory=plug_in.entry.value,
        origin=plug_in.origin,
        unavailable=declared.problem,
    )


def _why_left_out(
    plug_in: _PlugIn, known: Mapping[str, Mapping[str, DetectorRow | DescriptorRow | MatcherRow]]
) -> str | None:
    """Why the name of a plug-in cannot stand in a combination, or None if it can."""
    if not METHOD_NAME.fullmatch(plug_in.name):
        return (
            f"the plug-in {plug_in.origin} offers a method called {plug_in.entry.name!r}, which is "
            "left out: a name may consist of A-Z, 0-9 and _ only; rename its entry point"
        )
    for kind in KINDS[plug_in.group]:
        if taken := known[kind].get(plug_in.name):
            return (
                f"the plug-in {plug_in.origin} offers a {kind} {plug_in.name}, which is left out: "
                f"{taken.origin} has one of that name; rename its entry point or uninstall it"
            )
    return None


def installed_methods() -> Methods:
    """OpenCV's methods and those of the plug-ins installed beside aerocues.

    A plug-in that cannot be loaded, or describes itself wrongly, is listed as unavailable; one
    whose name is malformed or taken is left out and told in ``problems``.
    """
    base = opencv_methods()
    detectors, descriptors = dict(base.detectors), dict(base.descriptors)
    matchers = dict(base.matchers)
    problems: list[str] = []
    for plug_in in _plug_ins():
        known: dict[str, Mapping[str, DetectorRow | DescriptorRow | MatcherRow]] = {
            "detector": detectors,
            "descriptor": descriptors,
            "matcher": {**matchers, **base.on_request},
        }
        if problem := _why_left_out(plug_in, known):
            problems.append(problem)
            continue
        declared = read_declaration(plug_in.entry, plug_in.group)
        if "detector" in KINDS[plug_in.group]:
            detectors[plug_in.name] = _detector(plug_in, declared)
        if "descriptor" in KINDS[plug_in.group]:
            descriptors[plug_in.name] = _descriptor(plug_in, declared)
        if "matcher" in KINDS[plug_in.group]:
            matchers[plug_in.name] = _matcher(plug_in, declared)
    return replace(
        base,
        detectors=detectors,
        descriptors=descriptors,
        matchers=matchers,
        problems=tuple(problems),
    )
