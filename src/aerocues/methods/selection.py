"""Choosing combinations by patterns such as ``ORB-*-HAM-BF,AKAZE-SIFT-*,!*-VGG-*``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from fnmatch import fnmatchcase
from typing import Any

from aerocues.errors import SelectionError
from aerocues.methods.combination import Combination
from aerocues.methods.compatibility import why_incompatible, why_meaningless, why_unavailable
from aerocues.methods.registry import Methods

WILDCARDS = frozenset("*?[")
WITH = "+"
"""Begins the name of a set of methods on request, such as ``+extra``."""
SHOWN = 4
"""Measured combinations that an error names."""


Patterns = str | Combination | Iterable[str | Combination]
"""Globs such as ``"ORB-*-HAM-BF,AKAZE-*"``, one combination, or several of both."""


def split_names(names: Patterns | None) -> list[str]:
    """Names or patterns one by one, in upper case; a text is split at its commas."""
    if names is None:
        return []
    if isinstance(names, str | Combination):
        names = str(names).split(",")
    parts = [str(name) for name in names]
    return [part.strip().upper() for part in parts if part.strip()]


@dataclass(frozen=True)
class Asked:
    """What patterns ask for.

    Parameters
    ----------
    includes, excludes : tuple of str
        Globs in upper case.
    sets : frozenset of str
        Sets of methods on request that wildcards take, too.
    named : frozenset of str
        Methods that are named besides.
    """

    includes: tuple[str, ...]
    excludes: tuple[str, ...]
    sets: frozenset[str]
    named: frozenset[str]

    @classmethod
    def of(cls, patterns: Patterns | None, methods: Methods, named: Iterable[str] = ()) -> Asked:
        """Read patterns; SelectionError where a set does not exist."""
        wanted = split_names(patterns)
        sets = frozenset(text[1:].lower() for text in wanted if text.startswith(WITH))
        if unknown := sorted(sets.difference(methods.sets)):
            known = ", ".join(methods.sets)
            raise SelectionError(f"there is no set of methods {unknown[0]!r}; known are {known}")
        includes = tuple(text for text in wanted if text[0] not in f"!{WITH}")
        excludes = tuple(text[1:] for text in wanted if text.startswith("!"))
        return cls(includes or ("*",), excludes, sets, frozenset(named))

    def takes(self, pattern: str, combination: Combination, methods: Methods) -> bool:
        """Whether a pattern in upper case takes a combination.

        Wildcards alone do not take those with a method on request, nor keypoints that a pair
        matcher guides. A pair matcher's own name takes its combination.
        """
        if combination.guided and combination.matcher not in pattern:
            return False
        return matches(pattern, combination) and all(
            not row.on_request
            or row.on_request in self.sets
            or row.name in self.named
            or row.name in pattern
            for row in methods.rows(combination)
        )

    def leaves_out(self, combination: Combination) -> bool:
        """Whether a combination is excluded."""
        return any(matches(pattern, combination) for pattern in self.excludes)


def matches(pattern: str, combination: Combination) -> bool:
    """Whether a pattern in upper case is the text form, or the own name of a pair matcher."""
    own = combination.of_pairs and not combination.guided
    names = [str(combination), *([combination.matcher] if own else [])]
    return any(fnmatchcase(name, pattern) for name in names)


def select_measured(
    methods: Methods, patterns: Patterns, measured: Iterable[str | Combination]
) -> list[str]:
    """Choose among combinations that were measured, whatever can run here.

    Wildcards take methods on request, too: they were asked for when they were measured.

    Raises
    ------
    SelectionError
        If a pattern matches nothing that was measured.
    """
    asked = Asked.of(patterns, methods)
    known = [Combination.parse(str(each)) for each in measured]
    for pattern in asked.includes:
        if not any(matches(pattern, each) for each in known):
            told = ", ".join(map(str, known[:SHOWN])) + (", ..." if known[SHOWN:] else "")
            raise SelectionError(f"no measured combination matches {pattern!r}; choose from {told}")
    return [
        str(each)
        for each in known
        if any(matches(pattern, each) for pattern in asked.includes) and not asked.leaves_out(each)
    ]


def runnable(methods: Methods, *, on_request: bool = False) -> list[Combination]:
    """Every combination that OpenCV or a plug-in can run here; see `Methods.combinations`."""
    return [
        combination
        for combination in methods.combinations(on_request=on_request)
        if why_incompatible(combination, methods) is None
        and why_unavailable(combination, methods) is None
    ]


def meaningful(methods: Methods) -> list[Combination]:
    """The runnable combinations whose figures mean something: the default selection."""
    return [
        combination
        for combination in runnable(methods)
        if why_meaningless(combination, methods) is None
    ]


def _unmatched(asked: Asked, pattern: str, methods: Methods) -> SelectionError:
    everything = list(methods.combinations(on_request=True))
    matched = [each for each in everything if asked.takes(pattern, each, methods)]
    if matched:
        first = matched[0]
        reason = (
            why_unavailable(first, methods)
            or why_incompatible(first, methods)
            or f"{why_meaningless(first, methods)} (`everything=True` runs it all the same)"
        )
        return SelectionError(f"{pattern} selects nothing that can run: {first}: {reason}")
    if requested := [each for each in everything if matches(pattern, each)]:
        return SelectionError(_on_request(pattern, requested, methods))
    # A part of a name is no misspelt whole one: it wants its stars.
    for whole in (f"{pattern}-*", f"*-{pattern}-*", f"*-{pattern}"):
        if any(asked.takes(whole, each, methods) for each in everything):
            return SelectionError(f"no combination matches {pattern!r}; did you mean '{whole}'?")
    close = get_close_matches(pattern, [str(text) for text in everything], n=3, cutoff=0.6)
    hint = f"did you mean {', '.join(close)}?" if close else "see 'aerocues methods' for the names"
    return SelectionError(f"no combination matches {pattern!r}; {hint}")


def _on_request(pattern: str, requested: Sequence[Combination], methods: Methods) -> str:
    """Why a pattern takes nothing though it matches; no set brings guided keypoints."""
    rows = (row for each in requested if not each.guided for row in methods.rows(each))
    sets = dict.fromkeys(f"{WITH}{row.on_request}" for row in rows if row.on_request)
    remedy = " or add ".join(["name them in full", *sets])
    return f"{pattern!r} matches only methods on request, such as {requested[0]}; {remedy}"


def _require_sets(sets: Iterable[str], can_run: Iterable[Combination], methods: Methods) -> None:
    """Check that something of each set that is asked for can be used here."""
    usable = {row.on_request for each in can_run for row in methods.rows(each)}
    for name in sorted(set(sets) - usable):
        reason = _why_unusable(name, methods)
        raise SelectionError(f"nothing of {WITH}{name} can be used here: {reason}")


def _why_unusable(name: str, methods: Methods) -> str:
    """Why no method of a set can be used: one is not there, or nothing that is there fits it."""
    tables: tuple[Mapping[str, Any], ...]
    tables = (methods.detectors, methods.descriptors, methods.matchers)
    for row in (row for table in tables for row in table.values() if row.on_request == name):
        if row.unavailable:
            return f"{row.name} is unavailable: {row.unavailable}"
    with_one = (
        each
        for each in methods.combinations(on_request=True)
        if any(row.on_request == name for row in methods.rows(each))
    )
    reasons = (
        why_unavailable(each, methods) or why_incompatible(each, methods) for each in with_one
    )
    return next(filter(None, reasons), "it fits no other method")


def _by_component(
    candidates: list[Combination], component: str, names: Sequence[str]
) -> list[Combination]:
    if not names:
        return candidates
    for name in names:
        if not any(fnmatchcase(getattr(candidate, component), name) for candidate in candidates):
            known = ", ".join(dict.fromkeys(getattr(c, component) for c in candidates))
            raise SelectionError(f"no {component} {name} to select; there are {known}")
    return [
        candidate
        for candidate in candidates
        if any(fnmatchcase(getattr(candidate, component), name) for name in names)
    ]


def select(
    methods: Methods,
    patterns: Patterns | None = None,
    *,
    detectors: str | Iterable[str] | None = None,
    descriptors: str | Iterable[str] | None = None,
    everything: bool = False,
) -> list[Combination]:
    """Choose combinations.

    Parameters
    ----------
    methods : Methods
    patterns : str, Combination or iterable of both, optional
        Globs over the text form, separated by commas, in any case; a leading ``!`` takes out. A
        full name without wildcards is taken even where it is runnable but not meaningful. A
        method on request must be named, or the set in which it is offered, as in ``*,+extra``.
    detectors, descriptors : str or iterable of str, optional
        Names or globs of the detectors and descriptors to keep.
    everything : bool
        Choose among all runnable combinations, not only the meaningful ones.

    Returns
    -------
    list of Combination
        In the order of the tables, without repetition.

    Raises
    ------
    SelectionError
        If a pattern selects nothing.
    """
    can_run = runnable(methods, on_request=True)
    usual = [each for each in can_run if everything or why_meaningless(each, methods) is None]
    kept_detectors, kept_descriptors = split_names(detectors), split_names(descriptors)
    asked = Asked.of(patterns, methods, (*kept_detectors, *kept_descriptors))
    _require_sets(asked.sets, can_run, methods)
    chosen: set[Combination] = set()
    for pattern in asked.includes:
        pool = usual if WILDCARDS & set(pattern) else can_run
        found = {candidate for candidate in pool if asked.takes(pattern, candidate, methods)}
        if not found:
            raise _unmatched(asked, pattern, methods)
        chosen |= found
    kept = [each for each in can_run if each in chosen and not asked.leaves_out(each)]
    kept = _by_component(kept, "detector", kept_detectors)
    kept = _by_component(kept, "descriptor", kept_descriptors)
    if not kept:
        raise SelectionError("the selection is empty; take out fewer combinations")
    return kept


def select_one(methods: Methods, combination: str | Combination) -> Combination:
    """The one combination of a name.

    Raises
    ------
    SelectionError
        If there is none, or there are several.
    """
    chosen = select(methods, str(combination))
    if len(chosen) != 1:
        raise SelectionError(
            f"{combination} names {len(chosen)} combinations; name one, such as {chosen[0]}"
        )
    return chosen[0]
