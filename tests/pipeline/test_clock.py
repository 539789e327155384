from __future__ import annotations

import time
from collections.abc import Callable

import cv2
import numpy as np
import pytest

from aerocues.pipeline.clock import REPEATS, SECONDS_OF_REPEATS, Clock, StageTime


class Calls:
    """Counts its calls; each takes the next of some CPU and idle seconds."""

    def __init__(self, cpu: float = 0.0, idle: list[float] | None = None) -> None:
        self.count = 0
        self.random: list[float] = []
        self._cpu, self._idle = cpu, idle or []

    def __call__(self) -> int:
        self.random.append(float(cv2.randu(np.zeros(1), 0.0, 1.0)[0]))
        if self.count < len(self._idle):
            time.sleep(self._idle[self.count])
        until = time.thread_time() + self._cpu
        while time.thread_time() < until:
            pass
        self.count += 1
        return self.count


def test_a_shared_clock_calls_once() -> None:
    call = Calls(cpu=0.002)
    result, taken = Clock().time(call)
    assert (result, call.count) == (1, 1)
    assert (taken.repeats, taken.spread, taken.peak_memory) == (None, None, None)
    assert taken.wall >= taken.cpu >= 0.002


def test_an_exclusive_clock_returns_the_first_result_and_the_median_time() -> None:
    call = Calls(cpu=0.004)
    result, taken = Clock(exclusive=True).time(call)
    assert result == 1
    assert call.count >= REPEATS
    assert taken.repeats is not None
    assert 1 <= taken.repeats <= call.count
    assert taken.cpu >= 0.004


def test_random_numbers_are_seeded_before_each_call() -> None:
    call = Calls()
    Clock(seed=5, exclusive=True).time(call)
    assert len(set(call.random)) == 1
    other = Calls()
    Clock(seed=6).time(other)
    assert other.random[0] != call.random[0]


def test_a_call_that_was_disturbed_is_made_up_for() -> None:
    # The first call of three waits for as long as a disturbed one would; the others do not.
    call = Calls(cpu=0.05, idle=[0.2])
    _, taken = Clock(exclusive=True).time(call)
    assert call.count > REPEATS
    assert taken.wall < 0.2


def test_where_every_call_is_disturbed_the_time_says_so() -> None:
    call = Calls(cpu=0.02, idle=[0.02] * 20)
    _, taken = Clock(exclusive=True).time(call)
    assert taken.disturbed
    assert taken.repeats == call.count == 2 * REPEATS


def test_long_calls_are_not_repeated() -> None:
    call = Calls(idle=[SECONDS_OF_REPEATS])
    _, taken = Clock(exclusive=True).time(call)
    assert (call.count, taken.repeats, taken.spread) == (1, 1, None)


@pytest.mark.parametrize(
    ("first", "second", "both"),
    [
        (StageTime(1, 1), StageTime(2, 2), StageTime(3, 3)),
        (StageTime(1, 1, 5.0, 3, 0.1), StageTime(2, 2), StageTime(3, 3, 5.0, 3, 0.1)),
        (
            StageTime(1, 1, 5.0, 3, 0.1),
            StageTime(2, 1, 4.0, 2, 0.2),
            StageTime(3, 2, 5.0, 2, 0.2),
        ),
    ],
)
def test_times_add_up(first: StageTime, second: StageTime, both: StageTime) -> None:
    assert first + second == both


def test_short_calls_do_not_tell_whether_they_were_disturbed() -> None:
    assert not StageTime(wall=0.0009, cpu=0.0003).disturbed
    assert StageTime(wall=0.0113, cpu=0.01).disturbed
    assert not StageTime(wall=0.0109, cpu=0.01).disturbed


def test_what_raises_is_not_called_again() -> None:
    def fail() -> None:
        calls.append(1)
        raise ValueError("no")

    calls: list[int] = []
    clocks: list[Callable[[], None]] = [lambda: Clock(exclusive=True).time(fail)[0]]
    with pytest.raises(ValueError, match="no"):
        clocks[0]()
    assert len(calls) == 1
