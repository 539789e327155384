"""What a function that takes time tells while it works: one kind of event for all of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from aerocues.processes.call import StageCall


@dataclass(frozen=True)
class Activity:
    """What one worker is doing, and for how many seconds; or what work without any waits for."""

    worker: int
    call: StageCall | None
    seconds: float
    waiting_for: str = ""


@dataclass(frozen=True)
class Event:
    """How far a function has come. Each event is complete: a display needs the latest only.

    Parameters
    ----------
    stage : str
        What is being done: ``"reading images"``, ``"measuring"``, ``"racing"`` ...
    unit : str
        What is counted, in the plural: ``"rows"``.
    done, total : int
        How many of them are done; both 0 where that is not known.
    share : float
        Share of the work that was to do when the stage began, 0 to 1, by its expected cost.
    message : str
        A line to keep, about this event; mostly empty.
    standing : str
        How things stand, in a line that takes the place of the one before; may be empty.
    workers : tuple of Activity
        What the workers are doing.
    ends : float or None
        When the time that was given is up, by `time.monotonic`; None where there is no limit.
    rows : tuple of dict
        What has just been finished and stored: rows of `Results.table`, or of `Models.table`.
    """

    stage: str
    unit: str = ""
    done: int = 0
    total: int = 0
    share: float = 0.0
    message: str = ""
    standing: str = ""
    workers: tuple[Activity, ...] = ()
    rows: tuple[Mapping[str, Any], ...] = ()
    ends: float | None = None

    def __str__(self) -> str:
        counted = f"{self.done:,} of {self.total:,} {self.unit}" if self.total else ""
        return f"{self.stage}: {self.message or self.standing or counted}".removesuffix(": ")


Progress = Callable[[Event], None]
"""Called with each event: several times a second while workers are at it."""
Watch = Callable[[Sequence[Activity]], None]
"""Told what the workers are doing."""


class StageProgress:
    """Tells how one stage goes on.

    Parameters
    ----------
    progress : callable or None
        Called with each event; None for nobody.
    stage, unit, done, total, ends
        See `Event`.
    """

    def __init__(
        self,
        progress: Progress | None,
        stage: str,
        unit: str = "",
        done: int = 0,
        total: int = 0,
        *,
        ends: float | None = None,
    ) -> None:
        self._progress = progress
        self._event = Event(stage, unit, done, total, ends=ends)

    def tell(self, **changes: Any) -> None:
        """Tell what has changed; a message and rows belong to one event only."""
        self._event = replace(self._event, **{"message": "", "rows": (), **changes})
        if self._progress is not None:
            self._progress(self._event)

    def say(self, message: str) -> None:
        """Tell a line to keep."""
        self.tell(message=message)

    def count(self, done: int, total: int) -> None:
        """Tell how many are done."""
        self.tell(done=done, total=total)

    def watch(self, workers: Sequence[Activity]) -> None:
        """Tell what the workers are doing."""
        self.tell(workers=tuple(workers))

    def add(self, count: int, **changes: Any) -> None:
        """Tell that so many more are done."""
        self.tell(done=self._event.done + count, **changes)
