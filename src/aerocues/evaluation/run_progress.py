"""The progress of a run, as events."""

from __future__ import annotations

from aerocues.evaluation.engine import Finished
from aerocues.evaluation.plan import Exclusion, Plan
from aerocues.phrases import count
from aerocues.progress import Progress, StageProgress
from aerocues.results.timing import Timing


class RunProgress:
    """Turns the progress of a run into events.

    Parameters
    ----------
    progress : callable or None
        Called with each event.
    """

    def __init__(self, progress: Progress | None) -> None:
        self._progress = progress
        self._reading = StageProgress(progress, "reading images", "images")
        self._surveying = StageProgress(progress, "surveying the flight", "images and pairs")
        self._lowering = StageProgress(progress, "setting thresholds", "detectors")
        self._measuring = StageProgress(progress, "measuring", "rows")
        self._passes = 0
        self._cost_total = self._cost_done = 0.0
        self.read = self._reading.count
        self.surveyed = self._surveying.count
        self.thresholds = self._lowering.count
        self.note = self._surveying.say

    def set_aside(self, rows: int) -> None:
        """Report the number of rows of other settings, which are now ignored."""
        self._reading.tell(
            message=f"{count(rows, 'row')} of other images or settings in this folder are kept but "
            "ignored; measure with those settings again to use them, or choose another `output`"
        )

    def planned(self, plan: Plan, timing: Timing) -> None:
        """Report that the work of a pass was divided into units."""
        alone = timing == "exclusive"
        stage, unit = ("timing", "rows timed alone") if alone else ("measuring", "rows")
        self._measuring = StageProgress(
            self._progress, stage, unit, done=plan.rows_present, total=plan.rows_planned
        )
        self._cost_total, self._cost_done = sum(unit.cost for unit in plan.units), 0.0
        for line in () if self._passes else _left_out(plan):
            self._measuring.tell(message=line)
        self._passes += 1
        self._measuring.tell(message=_work(plan, alone=alone))
        self.watch = self._measuring.watch

    def finished(self, finished: Finished) -> None:
        """Report that a part of a unit is finished and stored."""
        self._cost_done = min(self._cost_done + finished.unit.cost, self._cost_total)
        share = self._cost_done / self._cost_total if self._cost_total else 1.0
        self._measuring.add(len(finished.rows), share=share, rows=tuple(finished.rows))


def _left_out(plan: Plan) -> list[str]:
    """Combinations that are excluded for these images: one line per reason."""
    by_reason: dict[str, list[Exclusion]] = {}
    for exclusion in plan.exclusions:
        by_reason.setdefault(exclusion.reason, []).append(exclusion)
    return [
        f"left out: {count(len(found), 'combination')} on "
        f"{count(max(exclusion.pairs for exclusion in found), 'pair')}, because {reason}"
        for reason, found in by_reason.items()
    ]


def _work(plan: Plan, *, alone: bool) -> str:
    """``100 rows to measure in 20 units of work``; empty if no work is left."""
    if not plan.rows_left:
        return ""
    present = f"; {plan.rows_present:,} rows are already stored" if plan.rows_present else ""
    what = "to time, one call at a time," if alone else "to measure"
    units = count(len(plan.units), "unit")
    return f"{count(plan.rows_left, 'row')} {what} in {units} of work{present}"
