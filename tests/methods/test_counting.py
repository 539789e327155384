"""Combinations counted by what can be done with them."""

from __future__ import annotations

from aerocues.methods.counting import count_combinations, count_left_out, named
from aerocues.methods.registry import opencv_methods
from aerocues.methods.selection import select


def test_every_combination_of_opencv_counts_once() -> None:
    counts = count_combinations(opencv_methods())
    assert (counts.declared, counts.runnable, counts.meaningful) == (784, 467, 340)
    assert counts.unavailable == 0
    assert sum(counts.incompatible.values()) == 784 - 467


def test_what_is_named_is_chosen_or_left_out_for_a_cause() -> None:
    methods = opencv_methods()
    asked = named(methods, "orb-*,!*-vgg-*", descriptors="s*,orb")
    assert {str(combination)[:8] for combination in asked} == {"ORB-SIFT", "ORB-ORB-"}
    assert len(asked) == 8
    chosen = select(methods, "orb-*,!*-vgg-*", descriptors="s*,orb")
    left_out = count_left_out(asked, frozenset(chosen), methods)
    assert len(chosen) + sum(left_out.values()) == 8
    assert len(named(methods)) == 784
