"""Whether there is time for another model."""

from __future__ import annotations

import math

import pytest

from aerocues.methods.combination import Combination
from aerocues.reconstruction.remaining_time import RemainingTime

ORB, SIFT = (Combination.parse(name) for name in ("ORB-ORB-HAM-BF", "SIFT-SIFT-L2-BF"))


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


def test_without_a_deadline_all_may_begin() -> None:
    left = RemainingTime(math.inf)
    left.worked(ORB, 1e9, made=True)
    assert left.allows([0.1])
    assert not left.limited


def test_until_a_model_is_made_others_may_use_free_cores_only() -> None:
    left = RemainingTime(130.0, Clock())
    assert left.allows([])
    assert left.allows([0.9, 0.75])
    assert not left.allows([0.9, 0.5])


def test_another_model_needs_what_those_before_it_took() -> None:
    """Matching 4 s and mapping 6 s in the one, 20 s in the other: 15 s in the mean."""
    clock = Clock()
    left = RemainingTime(130.0, clock)
    left.worked(ORB, 4.0, made=False)
    assert left.needed is None
    left.worked(ORB, 6.0, made=True)
    left.worked(SIFT, 20.0, made=True)
    assert left.needed == pytest.approx(15.0)
    clock.now = 115.0
    assert left.allows([])
    clock.now = 115.1
    assert not left.allows([])
    clock.now = 140.0
    assert left.left == 0.0


def test_models_that_were_there_tell_by_their_cpu_seconds() -> None:
    left = RemainingTime(130.0, Clock())
    left.learn({ORB: {"reconstruction_seconds": None}, SIFT: {"reconstruction_seconds": 31.0}})
    assert left.needed == pytest.approx(31.0)
    assert not left.allows([])
