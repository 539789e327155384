"""How many combinations there are, how many can run, and what keeps the others from it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase

from aerocues.methods.combination import Combination
from aerocues.methods.compatibility import RULES, incompatibility, why_meaningless, why_unavailable
from aerocues.methods.registry import Methods
from aerocues.methods.selection import Asked, split_names

UNAVAILABLE = "a method is unavailable here"
MEANINGLESS = "runs but means nothing: L2 norm on strings of bits"


@dataclass(frozen=True)
class Counts:
    """Combinations by what can be done with them.

    ``runnable`` includes the meaningful ones; ``incompatible`` counts by cause.
    """

    declared: int
    runnable: int
    meaningful: int
    unavailable: int
    incompatible: Mapping[str, int]


def count_combinations(methods: Methods) -> Counts:
    """Count every combination of `methods` once."""
    return _counts(methods.combinations(), methods)


def count_on_request(methods: Methods) -> dict[str, Counts]:
    """Count what each set of methods on request adds to the others, by the name of the set."""
    usual = frozenset(methods.combinations())
    every = methods.combinations(on_request=True)
    beyond = [each for each in every if each not in usual and not each.guided]
    sets = {each: {row.on_request for row in methods.rows(each)} - {""} for each in beyond}
    return {
        name: _counts((each for each in beyond if sets[each] == {name}), methods)
        for name in methods.sets
    }


def _counts(combinations: Iterable[Combination], methods: Methods) -> Counts:
    causes = Counter(_cause(combination, methods) for combination in combinations)
    meaningless, unavailable = causes[MEANINGLESS], causes[UNAVAILABLE]
    return Counts(
        declared=causes.total(),
        runnable=causes[None] + meaningless,
        meaningful=causes[None],
        unavailable=unavailable,
        incompatible={rule.cause: causes[rule.cause] for rule in RULES if causes[rule.cause]},
    )


def named(
    methods: Methods,
    patterns: str | Iterable[str] | None = None,
    *,
    detectors: str | Iterable[str] | None = None,
    descriptors: str | Iterable[str] | None = None,
) -> list[Combination]:
    """Every combination that the arguments of `select` name, runnable or not."""
    kept_detectors = split_names(detectors) or ["*"]
    kept_descriptors = split_names(descriptors) or ["*"]
    asked = Asked.of(patterns, methods, (*kept_detectors, *kept_descriptors))
    return [
        combination
        for combination in methods.combinations(on_request=True)
        if any(asked.takes(text, combination, methods) for text in asked.includes)
        and not asked.leaves_out(combination)
        and _matches(combination.detector, kept_detectors)
        and _matches(combination.descriptor, kept_descriptors)
    ]


def _matches(text: str, patterns: Iterable[str]) -> bool:
    return any(fnmatchcase(text, pattern) for pattern in patterns)


def count_left_out(
    combinations: Iterable[Combination], chosen: Container[Combination], methods: Methods
) -> dict[str, int]:
    """Count those of `combinations` that were not chosen, by what keeps them out."""
    causes = Counter(
        _cause(combination, methods) or "not chosen"
        for combination in combinations
        if combination not in chosen
    )
    return dict(causes.most_common())


def _cause(combination: Combination, methods: Methods) -> str | None:
    found = incompatibility(combination, methods)
    if found:
        return found[0]
    if why_unavailable(combination, methods):
        return UNAVAILABLE
    return MEANINGLESS if why_meaningless(combination, methods) else None
