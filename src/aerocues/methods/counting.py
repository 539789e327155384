"""How many combinations there are, how many can run, and what keeps the others from it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase

from aerocues.methods.combination import Combination
from aerocues.methods.compatibility import RULES, incompatibility, why_meaningless, why_unavailable
from aerocues.methods.registry import Methods
from aerocues.methods.selection import split_names, takes

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
    causes = Counter(_cause(combination, methods) for combination in methods.combinations())
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
    wanted = split_names(patterns)
    texts = [pattern for pattern in wanted if not pattern.startswith("!")] or ["*"]
    unwanted = [pattern[1:] for pattern in wanted if pattern.startswith("!")]
    kept_detectors = split_names(detectors) or ["*"]
    kept_descriptors = split_names(descriptors) or ["*"]
    return [
        combination
        for combination in methods.combinations(on_request=True)
        if any(takes(text, combination, methods) for text in texts)
        and not _matches(str(combination), unwanted)
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
