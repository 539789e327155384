"""Methods that other packages bring through entry points, and those that a program registers."""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any

from aerocues.errors import MethodUnavailableError, SelectionError
from aerocues.methods.combination import METHOD_NAME, NONE
from aerocues.methods.declarations import Declaration, read_declaration
from aerocues.methods.descriptors import DescriptorRow, DescriptorType
from aerocues.methods.detectors import DetectorRow
from aerocues.methods.matchers import MatcherRow
from aerocues.methods.pair_matchers import OF_PAIRS
from aerocues.methods.plugin_trial import tried_declaration
from aerocues.methods.registry import Methods, opencv_methods

KINDS: Mapping[str, tuple[str, ...]] = {
    "detectors": ("detector",),
    "descriptors": ("descriptor",),
    "extractors": ("detector", "descriptor"),
    "matchers": ("matcher",),
    "pair_matchers": ("detector", "matcher"),
}
"""The kinds of method that a plug-in of each group of entry points is."""


CHOICE = "AEROCUES_PLUGINS"
NO_PLUGINS = "none"
Known = Mapping[str, Mapping[str, DetectorRow | DescriptorRow | MatcherRow]]
"""Rows by kind and name."""
SAYS_KIND = {
    "extract": "extractor",
    "describe": "descriptor",
    "detect": "detector",
    "match_pair": "pair_matcher",
    "match": "matcher",
}
"""Kinds of method by the function that a class of that kind has."""


def load_factory(reference: str) -> Any:
    """The object that an entry point ``module:attribute`` names."""
    return EntryPoint(name="", value=reference, group="").load()


@dataclass(frozen=True)
class _PlugIn:
    """An entry point, the name of its method and who brings it."""

    name: str
    origin: str
    group: str
    entry: EntryPoint


_REGISTERED: dict[str, _PlugIn] = {}
"""What this program has registered, by group and name."""


def register(kind: str, name: str, method: str | type) -> None:
    """Add a method of your own to those that combinations are made of.

    It is measured like all others, in worker processes, too, which import it by its name. A method
    that was registered under the same name is replaced. Where the source of its module changes, it
    is another method: nothing that was measured before is taken for it.

    Parameters
    ----------
    kind : {"detector", "descriptor", "extractor", "matcher", "pair_matcher"}
        An extractor is a detector and a descriptor in one; a pair matcher matches two images as a
        whole, and its name alone is a combination.
    name : str
        How combinations name it: letters, digits and underscores, in any case.
    method : str or type
        Its class, as ``"module:Class"``, or itself, if a module has it; see
        `aerocues.methods.interfaces` for what it implements.

    Raises
    ------
    SelectionError
        If there is no such kind, or the name is malformed or that of another method.
    MethodUnavailableError
        If the class cannot be imported, or what it states is of another form.
    """
    if f"{kind}s" not in KINDS:
        raise SelectionError(f"`kind` must be one of {', '.join(SAYS_KIND.values())}, got {kind!r}")
    value = method if isinstance(method, str) else f"{method.__module__}:{method.__qualname__}"
    if value.startswith("__main__:"):
        raise MethodUnavailableError(
            f"worker processes cannot import {value}; write the class into a file, such as "
            f"mymodule.py, and register mymodule:{value.partition(':')[2]}"
        )
    entry = EntryPoint(name=name, value=value, group=f"aerocues.{kind}s")
    _REGISTERED.pop(f"{kind}s {name.upper()}", None)
    plug_in = _PlugIn(name.upper(), value, f"{kind}s", entry)
    methods = installed_methods()
    known: Known = {
        "detector": methods.detectors,
        "descriptor": methods.descriptors,
        "matcher": methods.matchers,
    }
    if reason := _why_unfit(plug_in, known):
        raise SelectionError(f"cannot register the {kind} {name}: {reason}; choose another name")
    if problem := read_declaration(entry, plug_in.group).problem:
        raise MethodUnavailableError(f"{value} cannot be used as {kind} {name.upper()}: {problem}")
    origin = f"{value} {_source_hash(entry.module)}".strip()
    _REGISTERED[f"{kind}s {plug_in.name}"] = replace(plug_in, origin=origin)


def register_class(reference: str) -> None:
    """Register ``module:Class`` under its ``name``, or that of the class, as what it implements.

    Raises
    ------
    SelectionError, MethodUnavailableError
        See `register`; also if the class implements no kind of method.
    """
    try:
        found = load_factory(reference)
    except (Exception, SystemExit) as error:  # third-party code may raise anything
        raise MethodUnavailableError(
            f"cannot import {reference!r}: {str(error) or type(error).__name__}; write it as "
            "module:Class, of a module in this folder or an installed one"
        ) from error
    kind = next((kind for function, kind in SAYS_KIND.items() if hasattr(found, function)), None)
    if kind is None:
        functions = ", ".join(SAYS_KIND)
        raise MethodUnavailableError(
            f"{reference} is not a method: it has none of the functions {functions}"
        )
    register(kind, getattr(found, "name", found.__name__), reference)


def _source_hash(module: str) -> str:
    """The beginning of the hash of a module's file; empty where there is none."""
    file = getattr(sys.modules.get(module), "__file__", None)
    if file is None:
        return ""
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()[:8]


def _installed() -> Iterator[_PlugIn]:
    """The plug-ins of packages that are installed."""
    for group in KINDS:
        for entry in sorted(entry_points(group=f"aerocues.{group}"), key=lambda entry: entry.name):
            origin = f"{entry.dist.name} {entry.dist.version}" if entry.dist else entry.value
            yield _PlugIn(entry.name.upper(), origin, group, entry)


def _plug_ins(problems: list[str]) -> Iterator[_PlugIn]:
    """The plug-ins that take part: those that `AEROCUES_PLUGINS` allows, and registered ones."""
    installed = list(_installed())
    asked = os.environ.get(CHOICE)
    if asked is not None:
        names = {name.strip().lower() for name in asked.split(",")} - {"", NO_PLUGINS}
        problems += [
            f"{CHOICE} names {name!r}, which is not an installed plug-in; correct it"
            for name in sorted(names.difference(*map(_called, installed)))
        ]
        installed = [plug_in for plug_in in installed if names & _called(plug_in)]
    yield from (*installed, *_REGISTERED.values())


def _called(plug_in: _PlugIn) -> set[str]:
    """The names of a plug-in in `AEROCUES_PLUGINS`: its own, and that of its package."""
    return {plug_in.name.lower(), plug_in.origin.partition(" ")[0].lower()}


def _declared(plug_in: _PlugIn) -> Declaration:
    """What a plug-in says about itself. What was registered has been imported here already."""
    if plug_in in _REGISTERED.values():
        return read_declaration(plug_in.entry, plug_in.group)
    return tried_declaration(plug_in.entry, plug_in.group)


def _detector(plug_in: _PlugIn, declared: Declaration) -> DetectorRow:
    return DetectorRow(
        plug_in.name,
        plug_in.entry.value,
        declared.parameters,
        declared.reference,
        limit=declared.limit or None,
        on_request=declared.on_request,
        upright=declared.upright,
        origin=plug_in.origin,
        unavailable=declared.why_not(),
    )


def _descriptor(plug_in: _PlugIn, declared: Declaration) -> DescriptorRow:
    return DescriptorRow(
        plug_in.name,
        plug_in.entry.value,
        declared.parameters,
        declared.reference,
        declared.dtype,
        only_detectors=(plug_in.name,) if plug_in.group == "extractors" else (),
        on_request=declared.on_request,
        upright=declared.upright,
        origin=plug_in.origin,
        unavailable=declared.why_not(),
    )


def _matcher(plug_in: _PlugIn, declared: Declaration) -> MatcherRow:
    of_pairs = plug_in.group == "pair_matchers"
    any_type: Mapping[str, tuple[DescriptorType, ...]] = {"L2": ("float32",), "HAM": ("uint8",)}
    dtypes = OF_PAIRS if of_pairs else declared.dtypes or any_type
    return MatcherRow(
        plug_in.name,
        declared.title or plug_in.name,
        declared.reference,
        dict.fromkeys(dtypes, declared.parameters),
        dtypes,
        factory=plug_in.entry.value,
        takes_descriptors=declared.takes_descriptors,
        of_pairs=of_pairs,
        on_request=declared.on_request,
        upright=declared.upright,
        origin=plug_in.origin,
        unavailable=declared.why_not(),
    )


def _why_unfit(plug_in: _PlugIn, known: Known) -> str | None:
    """Why the name of a plug-in cannot stand in a combination, or None if it can."""
    if not METHOD_NAME.fullmatch(plug_in.name):
        return "a name may consist of A-Z, 0-9 and _ only"
    if plug_in.name == NONE:
        return f"{NONE} stands for the descriptor of pair matchers"
    for kind in KINDS[plug_in.group]:
        if taken := known[kind].get(plug_in.name):
            return f"{taken.origin} has a {kind} of that name"
    return None


def installed_methods() -> Methods:
    """OpenCV's methods, those of the plug-ins installed beside aerocues, and registered ones.

    A plug-in that cannot be loaded, or describes itself wrongly, is listed as unavailable; one
    whose name is malformed or taken is left out and told in ``problems``. The environment variable
    ``AEROCUES_PLUGINS`` leaves out all (``none``), or all but those it names (``name,...``, of
    plug-ins or of packages).
    """
    methods = opencv_methods()
    problems: list[str] = []
    for plug_in in _plug_ins(problems):
        known: Known = {
            "detector": methods.detectors,
            "descriptor": methods.descriptors,
            "matcher": methods.matchers,
        }
        if reason := _why_unfit(plug_in, known):
            problems.append(
                f"the plug-in {plug_in.origin} offers {plug_in.entry.name!r}, which is left out: "
                f"{reason}; rename its entry point"
            )
            continue
        methods = _with(methods, plug_in)
    return replace(methods, problems=tuple(problems))


def _with(methods: Methods, plug_in: _PlugIn) -> Methods:
    """The methods and a plug-in."""
    declared, name, kinds = _declared(plug_in), plug_in.name, KINDS[plug_in.group]
    if plug_in.group == "pair_matchers":
        return methods.with_pair_matcher(_matcher(plug_in, declared))
    detectors, descriptors = dict(methods.detectors), dict(methods.descriptors)
    matchers = dict(methods.matchers)
    if "detector" in kinds:
        detectors[name] = _detector(plug_in, declared)
    if "descriptor" in kinds:
        descriptors[name] = _descriptor(plug_in, declared)
    if "matcher" in kinds:
        matchers[name] = _matcher(plug_in, declared)
    return replace(methods, detectors=detectors, descriptors=descriptors, matchers=matchers)
