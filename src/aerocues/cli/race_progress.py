"""Progress of a race on standard error: a status line on a terminal, lines elsewhere."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from aerocues.cli.console import count, likelihood
from aerocues.cli.progress import spoken_seconds
from aerocues.evaluation.engine import Activity
from aerocues.tuning.race import Round
from aerocues.tuning.recommend import Follower

if TYPE_CHECKING:
    from rich.status import Status

SECONDS_BETWEEN_LINES = 15.0


class RaceLines(Follower):
    """Writes a line for each important event."""

    def __init__(self, budget: float) -> None:
        self._budget = budget
        self._said = float("-inf")

    def looking(self, pairs: int) -> None:
        self._say(f"testing which of {count(pairs, 'pair')} overlap")

    def racing(self, combinations: int, pairs: int) -> None:
        self._say(f"{count(combinations, 'combination')} race on {count(pairs, 'pair')}")

    def round(self, finished: Round) -> None:
        if time.monotonic() - self._said >= SECONDS_BETWEEN_LINES:
            self._say(self._state(finished))

    def _state(self, finished: Round) -> str:
        return (
            f"{spoken_seconds(finished.spent)} of {spoken_seconds(self._budget)}: "
            f"{count(finished.measured, 'measurement')}, {finished.leader} leads "
            f"({likelihood(finished.probability)}), {finished.contenders} can still be among the "
            "best"
        )

    def _say(self, line: str) -> None:
        self._said = time.monotonic()
        sys.stderr.write(f"{line}\n")
        sys.stderr.flush()


class RaceStatus(RaceLines):
    """Updates a single line."""

    def __init__(self, budget: float, status: Status) -> None:
        super().__init__(budget)
        self._status = status
        self._line = ""
        self._drawn = float("-inf")

    def round(self, finished: Round) -> None:
        self._say(self._state(finished))

    def working(self, activities: Sequence[Activity]) -> None:
        if time.monotonic() - self._drawn < 1.0:
            return
        self._drawn = time.monotonic()
        calls = "; ".join(str(each.call) for each in activities if each.call)
        self._status.update(f"{self._line}  [dim]{calls}[/dim]")

    def _say(self, line: str) -> None:
        self._line = line
        self._status.update(line)


@contextlib.contextmanager
def follow(budget: float) -> Iterator[Follower]:
    """The display for standard error."""
    if not sys.stderr.isatty():
        yield RaceLines(budget)
        return
    from rich.console import Console

    with Console(stderr=True, highlight=False).status("reading images") as status:
        yield RaceStatus(budget, status)
