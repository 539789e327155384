from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain, cycle, repeat

import cv2
import numpy as np
import pytest

from aerocues.pipeline.clock import REPEATS, SECONDS_OF_REPEATS, Clock, StageTime


@dataclass
class Machine:
    """Its time goes by in calls only."""

    wall: float = 0.0
    cpu: float = 0.0

    def perf_counter(self) -> float:
        return self.wall

    def process_time(self) -> float:
        return self.cpu


def test_a_method_is_charged_for_what_its_threads_do() -> None:
    def in_a_thread() -> None:
        working = threading.Thread(target=lambda: sum(range(2_000_000)))
        working.start()
        working.join()

    begun = time.process_time()
    _, taken = Clock().time(in_a_thread)
    spent = time.process_time() - begun
    assert 0.5 * spent < taken.cpu <= spent


@pytest.fixture
def machine(monkeypatch: pytest.MonkeyPatch) -> Machine:
    made = Machine()
    monkeypatch.setattr("aerocues.pipeline.clock.time", made)
    return made


class Calls:
    """Counts its calls; each takes the next of some CPU and idle seconds of a machine."""

    def __init__(self, machine: Machine, cpu: Sequence[float], idle: Sequence[float] = ()) -> None:
        self.count = 0
        self.random: list[float] = []
        self._machine = machine
        self._cpu, self._idle = cycle(cpu), chain(idle, repeat(0.0))

    def __call__(self) -> int:
        self.random.append(float(cv2.randu(np.zeros(1), 0.0, 1.0)[0]))
        cpu = next(self._cpu)
        self._machine.cpu += cpu
        self._machine.wall += cpu + next(self._idle)
        self.count += 1
        return self.count


def test_a_shared_clock_calls_once(machine: Machine) -> None:
    call = Calls(machine, cpu=[0.25], idle=[0.5])
    assert Clock().time(call) == (1, StageTime(wall=0.75, cpu=0.25))
    assert call.count == 1


def test_an_exclusive_clock_returns_the_first_result_and_the_median_time(machine: Machine) -> None:
    call = Calls(machine, cpu=[0.25, 0.125, 0.1875])
    result, taken = Clock(exclusive=True).time(call)
    assert (result, call.count, taken.repeats) == (1, REPEATS, REPEATS)
    assert (taken.wall, taken.cpu) == (0.1875, 0.1875)
    assert taken.spread == (0.25 - 0.125) / 0.1875


def test_random_numbers_are_seeded_before_each_call(machine: Machine) -> None:
    call = Calls(machine, cpu=[0.25])
    Clock(seed=5, exclusive=True).time(call)
    assert len(set(call.random)) == 1
    other = Calls(machine, cpu=[0.25])
    Clock(seed=6).time(other)
    assert other.random[0] != call.random[0]


def test_a_call_that_was_disturbed_is_made_up_for(machine: Machine) -> None:
    # The first call of three waits as one would that was disturbed; the others do not.
    call = Calls(machine, cpu=[0.0625], idle=[0.25])
    _, taken = Clock(exclusive=True).time(call)
    assert (call.count, taken.repeats) == (REPEATS + 1, REPEATS)
    assert (taken.wall, taken.disturbed) == (0.0625, False)


def test_where_every_call_is_disturbed_the_time_says_so(machine: Machine) -> None:
    call = Calls(machine, cpu=[0.0625], idle=[0.0625] * 20)
    _, taken = Clock(exclusive=True).time(call)
    assert taken.disturbed
    assert taken.repeats == call.count == 2 * REPEATS


def test_long_calls_are_not_repeated(machine: Machine) -> None:
    call = Calls(machine, cpu=[SECONDS_OF_REPEATS])
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
