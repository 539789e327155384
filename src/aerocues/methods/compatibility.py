"""Which combinations cannot run, which run but mean nothing, and why: one rule a row."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from aerocues.methods.combination import NONE, Combination
from aerocues.methods.descriptors import DescriptorRow
from aerocues.methods.matchers import MatcherRow
from aerocues.methods.registry import Methods


@dataclass(frozen=True)
class Rule:
    """One cause of incompatibility; ``reason`` gives None where it does not apply."""

    cause: str
    reason: Callable[[Combination, DescriptorRow, MatcherRow], str | None]


def _foreign_keypoints(
    combination: Combination, descriptor: DescriptorRow, matcher: MatcherRow
) -> str | None:
    allowed = descriptor.only_detectors
    if not allowed or combination.detector in allowed:
        return None
    return (
        f"the {descriptor.name} descriptor needs what only keypoints of {' or '.join(allowed)} "
        f"carry, not those of {combination.detector}"
    )


def _breaking_keypoints(
    combination: Combination, descriptor: DescriptorRow, matcher: MatcherRow
) -> str | None:
    return descriptor.not_detectors.get(combination.detector)


def _foreign_descriptors(
    combination: Combination, descriptor: DescriptorRow, matcher: MatcherRow
) -> str | None:
    allowed = matcher.takes_descriptors
    if not allowed or descriptor.name in allowed:
        return None
    return f"{matcher.name} matches {' or '.join(allowed)} descriptors only, not {descriptor.name}"


def _unknown_norm(
    combination: Combination, descriptor: DescriptorRow, matcher: MatcherRow
) -> str | None:
    if combination.norm in matcher.dtypes:
        return None
    return f"the matcher {matcher.name} does not know the norm {combination.norm}"


def _bits_of_numbers(
    combination: Combination, descriptor: DescriptorRow, matcher: MatcherRow
) -> str | None:
    if combination.norm != "HAM" or descriptor.dtype == "uint8":
        return None
    return (
        f"the Hamming norm compares bits, but {descriptor.name} descriptors are "
        f"{descriptor.dtype} numbers; use L2"
    )


def _type_of_matcher(
    combination: Combination, descriptor: DescriptorRow, matcher: MatcherRow
) -> str | None:
    allowed = matcher.dtypes[combination.norm]
    if descriptor.dtype in allowed:
        return None
    return (
        f"{matcher.name} under {combination.norm} needs {' or '.join(allowed)} descriptors, but "
        f"{descriptor.name} descriptors are {descriptor.dtype}"
    )


RULES: tuple[Rule, ...] = (
    Rule("the descriptor needs keypoints of its own family", _foreign_keypoints),
    Rule("the detector's keypoints break the descriptor", _breaking_keypoints),
    Rule("the matcher is made for other descriptors", _foreign_descriptors),
    Rule("the matcher does not know the norm", _unknown_norm),
    Rule("Hamming norm on descriptors that are numbers", _bits_of_numbers),
    Rule("the matcher cannot take the descriptor's type", _type_of_matcher),
)


OF_PAIRS = "pair matchers match images as a whole, others descriptors"


def _why_not_of_pairs(combination: Combination, methods: Methods) -> str | None:
    """Why parts of a pair matcher and of other combinations do not fit together."""
    whole = Combination.of_pair_matcher(combination.matcher)
    if methods.matchers[combination.matcher].of_pairs:
        if (combination.descriptor, combination.norm) != (NONE, NONE):
            return f"{combination.matcher} is a pair matcher and compares no descriptors: {whole}"
        if combination.guided and methods.detectors[combination.detector].of_pairs:
            return f"{combination.detector} is a pair matcher, too, and one pair matcher is enough"
        return None
    if methods.detectors[combination.detector].of_pairs:
        return f"{combination.detector} is a pair matcher and detects nothing in a single image"
    if NONE in (combination.descriptor, combination.norm):
        return f"{combination.matcher} compares descriptors under a norm, and {NONE} is neither"
    return None


def incompatibility(combination: Combination, methods: Methods) -> tuple[str, str] | None:
    """The cause and the reason why `combination` cannot run, or None if it can.

    Raises
    ------
    SelectionError
        If one of the four names does not exist.
    """
    methods.require(combination)
    if reason := _why_not_of_pairs(combination, methods):
        return OF_PAIRS, reason
    descriptor = methods.descriptors[combination.descriptor]
    matcher = methods.matchers[combination.matcher]
    for rule in RULES:
        reason = rule.reason(combination, descriptor, matcher)
        if reason is not None:
            return rule.cause, reason
    return None


def why_incompatible(combination: Combination, methods: Methods) -> str | None:
    """Why `combination` cannot run, or None if it can."""
    found = incompatibility(combination, methods)
    return found[1] if found else None


def why_meaningless(combination: Combination, methods: Methods) -> str | None:
    """Why the figures of a runnable `combination` mean nothing, or None if they do."""
    descriptor = methods.descriptors[combination.descriptor]
    if combination.norm == "L2" and descriptor.bit_string:
        return (
            f"{descriptor.name} descriptors are strings of bits, on which the Euclidean distance "
            "of bytes means nothing; use HAM"
        )
    return None


def why_unavailable(combination: Combination, methods: Methods) -> str | None:
    """Why a method of `combination` cannot be used on this machine, or None if all can."""
    for row in methods.rows(combination):
        if row.unavailable:
            return f"{row.name} is unavailable: {row.unavailable}"
    return None
