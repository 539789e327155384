from __future__ import annotations

from collections import Counter

import pytest

from aerocues.errors import SelectionError
from aerocues.methods.combination import Combination
from aerocues.methods.compatibility import (
    incompatibility,
    why_incompatible,
    why_meaningless,
    why_unavailable,
)
from aerocues.methods.registry import Methods
from aerocues.methods.selection import meaningful, runnable


def test_number_of_declared_runnable_and_meaningful_combinations(methods: Methods) -> None:
    declared = list(methods.combinations())
    assert len(declared) == len(set(declared)) == 784
    assert len(runnable(methods)) == 467
    assert len(meaningful(methods)) == 340


def test_each_cause_rules_out_as_many_as_the_table_says(methods: Methods) -> None:
    counts: Counter[str] = Counter()
    by_pair: Counter[tuple[str, str]] = Counter()
    for combination in methods.combinations():
        found = incompatibility(combination, methods)
        if found:
            counts[found[0]] += 1
            by_pair[combination.detector, combination.descriptor] += 1
    assert counts == {
        "the descriptor needs keypoints of its own family": 96,
        "the detector's keypoints break the descriptor": 4 + 4,
        "Hamming norm on descriptors that are numbers": 86,
        "the matcher cannot take the descriptor's type": 127,
    }
    assert by_pair["SIFT", "ORB"] == 4
    assert by_pair["MSD", "SIFT"] == 4


def test_the_runnable_ones_without_meaning_are_bits_under_l2(methods: Methods) -> None:
    without = [c for c in runnable(methods) if why_meaningless(c, methods)]
    assert len(without) == 127
    assert {(c.norm, c.matcher) for c in without} == {("L2", "BF")}
    assert {methods.descriptors[c.descriptor].dtype for c in without} == {"uint8"}
    assert "LUCID" in {c.descriptor for c in without}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("FAST-AKAZE-HAM-BF", ["AKAZE", "KAZE", "FAST"]),
        ("SIFT-KAZE-L2-BF", ["AKAZE or KAZE", "SIFT"]),
        ("SIFT-ORB-HAM-BF", ["octave", "72 GB"]),
        ("MSD-SIFT-L2-BF", ["octaves", "pyramid"]),
        ("ORB-VGG-HAM-BF", ["bits", "VGG", "float32", "L2"]),
        ("SIFT-SIFT-HAM-FLANN", ["bits", "SIFT", "float32"]),
        ("ORB-ORB-L2-FLANN", ["FLANN", "float32", "uint8"]),
    ],
)
def test_the_reason_names_what_is_wrong(methods: Methods, text: str, words: list[str]) -> None:
    reason = why_incompatible(Combination.parse(text), methods)
    assert reason is not None
    for word in words:
        assert word in reason


@pytest.mark.parametrize(
    "text", ["ORB-BEBLID-HAM-BF", "KAZE-AKAZE-HAM-FLANN", "AKAZE-KAZE-L2-BF", "MSD-ORB-HAM-BF"]
)
def test_what_runs_has_no_reason(methods: Methods, text: str) -> None:
    combination = Combination.parse(text)
    assert why_incompatible(combination, methods) is None
    assert why_meaningless(combination, methods) is None
    assert why_unavailable(combination, methods) is None


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("NOPE-ORB-HAM-BF", "detector NOPE"),
        ("ORB-NOPE-HAM-BF", "descriptor NOPE"),
        ("ORB-ORB-L1-BF", "norm L1"),
        ("ORB-ORB-HAM-NOPE", "matcher NOPE"),
    ],
)
def test_unknown_names_are_errors_that_list_the_known(
    methods: Methods, text: str, kind: str
) -> None:
    with pytest.raises(SelectionError, match=kind):
        why_incompatible(Combination.parse(text), methods)
