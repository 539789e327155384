"""Progress of a run: the figures for both displays, and plain lines for files and pipes."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from aerocues.cli.console import count
from aerocues.evaluation.engine import Activity, Finished
from aerocues.evaluation.plan import Exclusion, Plan
from aerocues.evaluation.run import Observer
from aerocues.results.timing import Timing

SECONDS_BETWEEN_LINES = 10.0
SHARE_BETWEEN_LINES = 0.1
LONGEST_SILENCE = 60.0


def spoken_seconds(seconds: float) -> str:
    """``8 s``, ``4 min 05 s``, ``2 h 10 min``."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"


def waiting(activity: Activity) -> str:
    """``waiting for a worker, 2 min 00 s so far``."""
    return f"waiting for {activity.waiting_for}, {spoken_seconds(activity.seconds)} so far"


def left_out(plan: Plan) -> list[str]:
    """Combinations that the images rule out: one line per reason."""
    by_reason: dict[str, list[Exclusion]] = {}
    for exclusion in plan.exclusions:
        by_reason.setdefault(exclusion.reason, []).append(exclusion)
    return [
        f"left out: {count(len(found), 'combination')} on "
        f"{count(max(exclusion.pairs for exclusion in found), 'pair')}, because {reason}"
        for reason, found in by_reason.items()
    ]


def told_aside(rows: int) -> str:
    """The message about rows of other settings."""
    return (
        f"{count(rows, 'row')} of other images or settings are kept but ignored; rerun the command "
        "that measured them to use them again (give -o another folder to use both)"
    )


@dataclass
class Tally(Observer):
    """The progress of a pass; `clock` returns seconds."""

    clock: Callable[[], float] = time.monotonic
    plan: Plan | None = None
    rows_measured: int = 0
    statuses: Counter[str] = field(default_factory=Counter)
    timing: Timing = "shared"
    _started: float = 0.0
    _rows_before: int = 0
    _stored_before: int | None = None
    _cost_total: float = 0.0
    _cost_done: float = 0.0
    _began: float = 0.0
    _latest: float = 0.0

    def planned(self, plan: Plan, timing: Timing) -> None:
        if self.plan is None:
            self._started = self.clock()
        else:
            self._stored_before = self.rows_stored
        self._rows_before += self.rows_measured
        self.rows_measured, self._cost_done = 0, 0.0
        self.statuses.clear()
        self.plan, self.timing = plan, timing
        self._cost_total = sum(unit.cost for unit in plan.units)
        self._began = self._latest = self.clock()

    def finished(self, finished: Finished) -> None:
        self.rows_measured += len(finished.rows)
        self.statuses.update(str(row["status"]) for row in finished.rows)
        self._cost_done = min(self._cost_done + finished.unit.cost, self._cost_total)
        self._latest = self.clock()

    @property
    def rows_stored(self) -> int:
        return self.rows_measured + (self.plan.rows_present if self.plan else 0)

    @property
    def rows_measured_in_all(self) -> int:
        """Rows measured by all passes; timed rows count twice."""
        return self._rows_before + self.rows_measured

    def stored(self) -> str:
        """``36 rows are stored, 0 of 6 timed alone``."""
        if self._stored_before is None:
            return f"{self.rows_stored:,} rows are stored"
        timed = f"{self.rows_stored:,} of {self.rows_planned:,} timed alone"
        return f"{self._stored_before:,} rows are stored, {timed}"

    def there_already(self) -> str:
        """``all 36 rows are there already, 6 of them timed alone``."""
        if self._stored_before is None:
            return f"all {count(self.rows_stored, 'row')} are there already"
        rows = count(self._stored_before, "row")
        return f"all {rows} are there already, {self.rows_stored:,} of them timed alone"

    def measured(self) -> str:
        """``measured 75 rows and timed 30 alone``."""
        if self._stored_before is None:
            return f"measured {count(self.rows_measured, 'row')}"
        first = f"measured {count(self._rows_before, 'row')} and " if self._rows_before else ""
        return f"{first}timed {self.rows_measured:,} alone"

    @property
    def elapsed_in_all(self) -> float:
        """Seconds since the first pass began."""
        return self.clock() - self._started

    @property
    def rows_planned(self) -> int:
        return self.plan.rows_planned if self.plan else 0

    @property
    def share(self) -> float:
        """Share of the planned rows that exist, from 0 to 1."""
        return self.rows_stored / self.rows_planned if self.rows_planned else 1.0

    @property
    def elapsed(self) -> float:
        """Seconds since the work began."""
        return self.clock() - self._began

    def seconds_left(self) -> float | None:
        """Estimated seconds left, by cost; None until something is done."""
        if not self._cost_done:
            return None
        pace = (self._latest - self._began) / self._cost_done
        to_go = (self._cost_total - self._cost_done) * pace
        return max(to_go - (self.clock() - self._latest), 0.0)

    def progress(self) -> str:
        """``1,200 of 13,600 rows (9 %), 1 min 10 s so far, about 12 min 05 s left``."""
        left = self.seconds_left()
        ending = f", {spoken_seconds(self.elapsed)} so far"
        ending += "" if left is None or left < 1 else f", about {spoken_seconds(left)} left"
        share = f"{int(100 * self.share)} %"
        rows = "rows timed alone" if self.timing == "exclusive" else "rows"
        return f"{self.rows_stored:,} of {self.rows_planned:,} {rows} ({share}){ending}"

    def outcomes(self) -> str:
        """``ok 1,100, chance 80, crashed 20``: statuses of this run, ok first."""
        ordered = sorted(self.statuses.items(), key=lambda item: (item[0] != "ok", -item[1]))
        return ", ".join(f"{status} {number:,}" for status, number in ordered)


@dataclass
class PlainLines(Tally):
    """Occasional lines on standard error."""

    _line_time: float = 0.0
    _line_share: float = 0.0
    _waits: bool = False

    def set_aside(self, rows: int) -> None:
        self._say(told_aside(rows))

    def planned(self, plan: Plan, timing: Timing) -> None:
        first = self.plan is None
        super().planned(plan, timing)
        self._line_time, self._line_share = self.clock(), self.share
        for line in left_out(plan) if first else ():
            self._say(line)
        if not plan.rows_left:
            return
        present = f"; {plan.rows_present:,} rows are there already" if plan.rows_present else ""
        units = count(len(plan.units), "unit")
        what = "to time, one call at a time," if timing == "exclusive" else "to measure"
        self._say(f"{count(plan.rows_left, 'row')} {what} in {units} of work{present}")

    def working(self, activities: Sequence[Activity]) -> None:
        silent = self.clock() - self._line_time
        moved = self.share - self._line_share >= SHARE_BETWEEN_LINES
        told = [waiting(activity) for activity in activities if activity.waiting_for]
        begins, self._waits = bool(told) and not self._waits, bool(told)
        if begins or silent >= LONGEST_SILENCE or (moved and silent >= SECONDS_BETWEEN_LINES):
            self._line_time, self._line_share = self.clock(), self.share
            self._say("; ".join(filter(None, (*told, self.progress(), self.outcomes()))))

    def _say(self, line: str) -> None:
        sys.stderr.write(f"{line}\n")
        sys.stderr.flush()
