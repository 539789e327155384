"""Which unit a worker gets next."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aerocues.datasets.dataset import Dataset, Pair
from aerocues.evaluation.unit import PairWork, Unit
from aerocues.evaluation.unit_queue import UnitQueue
from aerocues.methods.combination import Combination
from tests.evaluation.scenes import dataset_of

COMBINATION = Combination("ORB", "ORB", "HAM", "BF")


def row_of_images(count: int) -> Dataset:
    """Consecutive pairs; nobody reads the images."""
    return dataset_of(Path("nowhere"), [f"{number}.png" for number in range(count)])


def unit(*pairs: int, detector: str = "ORB") -> Unit:
    work = tuple(PairWork(pair, (COMBINATION,), (f"{detector}{pair}",)) for pair in pairs)
    return Unit(detector, work)


A, B, C = unit(0, 1), unit(2, 3), unit(4, 5)


def test_a_worker_goes_on_where_it_holds_an_image() -> None:
    queue = UnitQueue([unit(0, 1, detector="FAST"), C, B], row_of_images(7))
    assert queue.take(A, []) == B
    assert queue.take(B, []) == C


def test_others_leave_it_the_next_unit_where_they_can() -> None:
    queue = UnitQueue([B, C], row_of_images(7))
    assert queue.take(None, [A]) == C
    assert queue.take(None, [A, C]) == B
    assert not queue
    with pytest.raises(IndexError):
        queue.take(None, [])


def test_another_detector_shares_nothing() -> None:
    other = unit(2, 3, detector="FAST")
    queue = UnitQueue([other, B], row_of_images(7))
    assert queue.take(None, [A]) == other
    assert queue.take(None, [A]) == B


def test_what_is_put_back_comes_first() -> None:
    queue = UnitQueue([A], row_of_images(7))
    queue.put_back([B, C])
    assert [queue.take(None, []) for _ in range(3)] == [B, C, A]


@given(st.lists(st.integers(0, 9), unique=True, min_size=1), st.data())
def test_every_unit_is_taken_once(numbers: list[int], data: st.DataObject) -> None:
    units = [unit(number) for number in numbers]
    queue = UnitQueue(units, row_of_images(11))
    taken: list[Unit] = []
    while queue:
        finished = data.draw(st.sampled_from([None, *taken]))
        taken.append(queue.take(finished, taken[-2:]))
    assert sorted(taken, key=units.index) == units


def test_pairs_of_a_part_keep_their_numbers() -> None:
    whole = row_of_images(7)
    part = Dataset("part", whole.images, [Pair(5, "5.png", "6.png", "s")], "epipolar")
    assert UnitQueue([unit(5)], part).take(unit(5), []) == unit(5)
