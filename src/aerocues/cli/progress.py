"""How work goes on, on standard error: the figures behind both displays, and plain lines."""

from __future__ import annotations

import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

from aerocues.cli.wording import in_options
from aerocues.phrases import spoken_seconds
from aerocues.progress import Activity, Event
from aerocues.standard_error import tell

SECONDS_BETWEEN_LINES = 10.0
SHARE_BETWEEN_LINES = 0.1
LONGEST_SILENCE = 60.0
# Whoever gave a budget watches it: how things stand is told at least every 5 seconds.
SECONDS_UNDER_A_BUDGET = 4.0
WIDTH = 80
READING = "reading images"


def waiting(activity: Activity) -> str:
    """``waiting for a worker, 2 min 00 s so far``."""
    return f"waiting for {activity.waiting_for}, {spoken_seconds(activity.seconds)} so far"


@dataclass
class Counted:
    """What was there when a stage began, what there is now, and what there is to be."""

    first: int
    done: int
    total: int
    unit: str

    @property
    def added(self) -> int:
        return self.done - self.first


@dataclass
class Tally:
    """What the events so far say; `clock` gives seconds."""

    clock: Callable[[], float] = time.monotonic
    event: Event = field(default_factory=lambda: Event(""))
    stages: dict[str, Counted] = field(default_factory=dict)
    statuses: Counter[str] = field(default_factory=Counter)
    began: float | None = None
    _stage_began: float = 0.0
    _latest: float = 0.0

    def __call__(self, event: Event) -> None:
        """Take in an event."""
        now = self.clock()
        self.began = now if self.began is None else self.began
        before, self.event = self.event, event
        if event.stage != before.stage:
            self._stage_began = self._latest = now
            self.statuses.clear()
        if event.share != before.share:
            self._latest = now
        if event.total:
            here = Counted(event.done, event.done, event.total, event.unit)
            here = self.stages.setdefault(event.stage, here)
            here.done, here.total = event.done, event.total
        self.statuses.update(str(row["status"]) for row in event.rows)

    @property
    def elapsed(self) -> float:
        """Seconds since the first event."""
        return 0.0 if self.began is None else self.clock() - self.began

    @property
    def counted(self) -> list[Counted]:
        """What stages have made, in order; reading images makes nothing."""
        return [each for stage, each in self.stages.items() if stage != READING]

    def seconds_left(self) -> float | None:
        """Seconds to go, by the cost of what is done and left; None as long as nothing is done."""
        share = self.event.share
        if not share:
            return None
        to_go = (self._latest - self._stage_began) * (1 - share) / share
        return max(to_go - (self.clock() - self._latest), 0.0)

    def progress(self) -> str:
        """``1,200 of 13,600 rows (9 %), 1 min 10 s so far, about 12 min 05 s left``."""
        event, left = self.event, None if self.event.ends else self.seconds_left()
        ending = f", {spoken_seconds(self.clock() - self._stage_began)} so far"
        ending += "" if left is None or left < 1 else f", about {spoken_seconds(left)} left"
        if not event.total:
            return f"{event.stage}{ending}"
        share = f"{int(100 * event.done / event.total)} %"
        return f"{event.done:,} of {event.total:,} {event.unit} ({share}){ending}"

    def shortly(self) -> str:
        """``1 of 3 models, about 1 min 10 s left``."""
        event, left = self.event, self.seconds_left()
        ending = "" if left is None or left < 1 else f", about {spoken_seconds(left)} left"
        return f"{event.done:,} of {event.total:,} {event.unit}{ending}"

    def stands(self) -> str:
        """How things stand, and what is left of the time that was given."""
        event = self.event
        if event.ends is None:
            return event.standing or self.progress()
        counted = f"{event.stage}: {event.done:,} of {event.total:,} {event.unit}"
        told = event.standing or (counted if event.total else event.stage)
        return f"{told}, {spoken_seconds(max(event.ends - self.clock(), 0.0))} left"

    def tick(self) -> None:
        """Called about every second, also while no event comes."""

    def outcomes(self) -> str:
        """``ok 1,100, chance 80, crashed 20``: of what this stage finished, ok first."""
        ordered = sorted(self.statuses.items(), key=lambda item: (item[0] != "ok", -item[1]))
        return ", ".join(f"{status} {number:,}" for status, number in ordered)

    def kept(self) -> str:
        """``36 of 36 rows, 2 of 6 rows timed alone are finished``; empty where nothing is."""
        finished = ", ".join(
            f"{each.done:,} of {each.total:,} {each.unit}" for each in self.counted
        )
        return f"{finished} are finished" if finished else ""


@dataclass
class PlainLines(Tally):
    """A line for each message, and one now and then that says how things stand."""

    _line_time: float = 0.0
    _line_share: float = 0.0
    _line_standing: str = ""
    _waits: bool = False
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def __call__(self, event: Event) -> None:
        with self._lock:
            begins = event.stage != self.event.stage
            super().__call__(event)
            if begins and event.ends is None:
                self._remember()
            if event.message:
                self._say(event.message)
            else:
                self._say_now_and_then()

    def tick(self) -> None:
        with self._lock:
            self._say_now_and_then()

    def _say_now_and_then(self) -> None:
        event = self.event
        if event.ends is not None:
            if self.clock() - self._line_time >= SECONDS_UNDER_A_BUDGET:
                self._say_briefly()
            return
        if event.stage == READING or self.began is None:
            return
        told = [waiting(each) for each in event.workers if each.waiting_for]
        begins, self._waits = bool(told) and not self._waits, bool(told)
        moved = (
            self._share() - self._line_share >= SHARE_BETWEEN_LINES
            or event.standing != self._line_standing
        )
        silent = self.clock() - self._line_time
        if begins or silent >= LONGEST_SILENCE or (moved and silent >= SECONDS_BETWEEN_LINES):
            calls = [each.call for each in event.workers if each.call]
            stands, doing = event.standing or self.progress(), [call.brief() for call in calls]
            if not told and any(call.total for call in calls):
                stands, doing = self.shortly(), doing[:1]
            elif moved or told:
                doing = []
            self._say("; ".join(filter(None, (*told, stands, self.outcomes(), *doing))))

    def _say_briefly(self) -> None:
        """How things stand, and what workers do as far as a line of 80 columns has room for it."""
        line = self.stands()
        for each in self.event.workers:
            more = f"{line}; {each.call.brief()}" if each.call else line
            line = more if len(more) <= WIDTH else line
        self._say(line)

    def _share(self) -> float:
        event = self.event
        return max(event.share, event.done / event.total if event.total else 0.0)

    def _remember(self) -> None:
        self._line_time, self._line_share = self.clock(), self._share()
        self._line_standing = self.event.standing

    def _say(self, line: str) -> None:
        self._remember()
        tell(f"{in_options(line)}\n")
