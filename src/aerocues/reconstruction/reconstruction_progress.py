"""The progress of a reconstruction, as events."""

from __future__ import annotations

from collections.abc import Sequence

from aerocues.methods.combination import Combination
from aerocues.phrases import count, spoken_seconds
from aerocues.processes.call import StageCall
from aerocues.progress import Activity, Progress, StageProgress
from aerocues.reconstruction.remaining_time import RemainingTime
from aerocues.results.metrics import Row
from aerocues.results.reconstruction_schema import BASELINE

# Where each stage of a model begins and ends, as shares of its time: rough, for the time left.
SHARES = {
    "detect": (0.0, 0.25),
    "describe": (0.0, 0.25),
    "match": (0.25, 0.45),
    "verification": (0.45, 0.75),
    "verify": (0.45, 0.75),
    "refinement": (0.75, 0.8),
    "mapping": (0.8, 0.97),
    "judging": (0.97, 1.0),
}


def share_of_model(call: StageCall | None) -> float:
    """How much of its model a process has done, 0 to 1.

    >>> share_of_model(StageCall("match", -1, "a and b", "ORB", number=9, total=17))
    0.34
    """
    if call is None or call.stage not in SHARES:
        return 0.0
    begins, ends = SHARES[call.stage]
    within = (call.number - 1) / call.total if call.total else 0.0
    return round(begins + (ends - begins) * within, 2)


class ReconstructionProgress:
    """Turns the progress of a reconstruction into events.

    Parameters
    ----------
    progress : callable or None
        Called with each event.
    """

    def __init__(self, progress: Progress | None) -> None:
        self._reading = StageProgress(progress, "reading images", "images")
        self._making = StageProgress(progress, "reconstructing", "models")
        self._done = self._total = self._present = 0
        self._reached = 0.0
        self.read = self._reading.count

    def left_out(self, combinations: Sequence[Combination], reason: str) -> None:
        """Report combinations that are excluded for these images."""
        what = count(len(combinations), "combination")
        self._making.tell(message=f"left out: {what}, because {reason}")

    def planned(self, total: int, present: int) -> None:
        """Report that `present` of `total` combinations are already finished."""
        self._done, self._total, self._present = present, total, present
        there = f"{present} of {total} models are already finished" if present else ""
        self._making.tell(done=present, total=total, message=there)

    def watch(self, activities: Sequence[Activity]) -> None:
        """Report the activity of the processes, and how far all models are."""
        begun = sum(share_of_model(each.call) for each in activities)
        self._making.tell(workers=tuple(activities), share=self._share(begun))

    def _share(self, begun: float = 0.0) -> float:
        """Share of what was to do; it does not fall where a model takes another way."""
        to_do = max(self._total - self._present, 1)
        reached = min((self._done - self._present + begun) / to_do, 1.0)
        self._reached = max(self._reached, reached)
        return self._reached

    def finished(self, row: Row) -> None:
        """Report that a combination is finished and stored."""
        self._done += 1
        name = "-".join(str(row[part]) for part in ("detector", "descriptor", "norm", "matcher"))
        self._making.tell(
            done=self._done,
            share=self._share(),
            message=f"{self._done} of {self._total}  {name}  {summary(row)}",
            rows=(row,),
        )

    def without_reference(self, reference: Combination, reason: str) -> None:
        """Report that there are no cloud distances, because the reference has no model."""
        self._making.tell(
            message=f"no distances between clouds: {reference} has no model ({reason})"
        )

    def without_baseline(self, reason: str) -> None:
        """COLMAP's default cannot be made with this version of it."""
        self._making.tell(message=f"no row of COLMAP's default: {reason}")

    def without_time(self, missing: Sequence[Combination], time_left: RemainingTime) -> None:
        """Report models for which the time before a deadline was not enough."""
        if not missing or not time_left.limited:
            return
        if BASELINE in missing:
            reason = "COLMAP's default, which is made first, was not finished"
        elif time_left.needed is None:
            reason = f"{missing[0]}, which is made next, was not finished"
        else:
            reason = f"each takes about {spoken_seconds(time_left.needed)}"
        self._making.tell(message=f"no time for {count(len(missing), 'model')}: {reason}")

    def note(self, message: str) -> None:
        """Report what concerns all models, such as whether their intrinsics are calibrated."""
        self._making.tell(message=message)


def summary(row: Row) -> str:
    """``ok: 18 of 18 images, 1,288 points, 0.34 px, 0.8 m``; only the status for a failure.

    The reasons, which can be long, are in the table.
    """
    parts = []
    if row.get("registered_images"):
        parts.append(f"{row['registered_images']} of {row['images']} images")
        parts.append(f"{row['points_3d']:,} points")
        if row.get("reprojection_error") is not None:
            parts.append(f"{row['reprojection_error']:.2f} px")
        if row.get("position_rmse") is not None:
            parts.append(f"{row['position_rmse']:.1f} m")
    return f"{row['status']}: {', '.join(parts)}" if parts else str(row["status"])
