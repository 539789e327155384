"""What a race tells, and that it looks at its budget before it begins, by a clock of the test."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from aerocues.errors import SelectionError
from aerocues.progress import Event
from aerocues.tuning.race import Round
from aerocues.tuning.race_progress import RaceProgress

BEGAN = 100.0


class Slow:
    """A clock that moves by some seconds whenever it is looked at."""

    def __init__(self, seconds: float) -> None:
        self.now, self.seconds = BEGAN, seconds

    def __call__(self) -> float:
        self.now += self.seconds
        return self.now


def steps_until_refused(step: Callable[[int, int], None], first: int, total: int) -> int:
    for done in range(first, total + 1):
        try:
            step(done, total)
        except SelectionError:
            return done
    return 0


def test_a_stage_that_cannot_end_in_time_is_refused_after_a_few_steps() -> None:
    step = RaceProgress(None, 60.0, BEGAN, Slow(2.0)).preparing("surveying the flight", "images")
    assert steps_until_refused(step, 1, 100) == 4


def test_slow_steps_at_first_do_not_tell_the_pace_of_steps_that_differ() -> None:
    told = RaceProgress(None, 60.0, BEGAN, Slow(0.9))
    step = told.preparing("setting thresholds", "detectors", alike=False)
    # Two looks at the clock a step: refused when half is done, not after four.
    assert steps_until_refused(step, 1, 60) == 30


def test_steps_of_another_kind_have_a_pace_of_their_own() -> None:
    clock = Slow(0.1)
    step = RaceProgress(None, 60.0, BEGAN, clock).preparing("surveying the flight", "images")
    assert steps_until_refused(step, 1, 10) == 0
    clock.now += 20  # what the first pair has to load
    assert steps_until_refused(step, 11, 40) == 0


def test_a_stage_that_has_time_goes_on_until_the_race_would_have_too_little() -> None:
    step = RaceProgress(None, 60.0, BEGAN, Slow(0.1)).preparing("setting thresholds", "detectors")
    for done in range(1, 15):
        step(done, 14)
    late = RaceProgress(None, 10.0, BEGAN - 9.5, Slow(0.1))
    with pytest.raises(SelectionError, match="budget"):
        late.preparing("setting thresholds", "detectors")


def test_a_race_that_began_before_is_not_refused() -> None:
    again = RaceProgress(None, 1.0, BEGAN - 50.0, Slow(1.0), strict=False)
    again.preparing("surveying the flight", "images")(1, 100)


def test_every_event_tells_when_the_time_is_up_and_rounds_tell_the_leader() -> None:
    events: list[Event] = []
    tell = RaceProgress(events.append, 60.0, BEGAN, Slow(0.0))
    tell.preparing("surveying the flight", "images")(1, 10)
    tell.resumed(5.0)
    tell.racing(10, 4)
    tell.round(Round(20.0, 12, 4, ["GFTT_H-TEBLID-HAM-FLANN"], 0.61))
    assert [event.ends for event in events] == [160.0, 160.0, 155.0, 155.0]
    assert events[-1].standing == "GFTT_H-TEBLID-HAM-FLANN leads (61%), 4 still in the race"
