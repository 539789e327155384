"""Progress of reconstructions: a line per model, and the current work on a terminal."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from aerocues.cli.console import count
from aerocues.cli.progress import spoken_seconds
from aerocues.methods.combination import Combination
from aerocues.reconstruction.engine import Doing
from aerocues.reconstruction.options import ReconstructionObserver
from aerocues.results.combination_columns import name_in_row
from aerocues.results.metrics import Row

if TYPE_CHECKING:
    from rich.status import Status

SECONDS_BETWEEN_DRAWINGS = 0.5
LONGEST_SILENCE = 60.0


@dataclass
class Reporter(ReconstructionObserver):
    """Reports on standard error; a `status` shows the current work."""

    status: Status | None = None
    total: int = 0
    done: int = 0
    _drawn: float = 0.0
    _began: float = 0.0

    def preparing(self, done: int, total: int) -> None:
        if self.status:
            self.status.update(f"reading images: {done:,} of {total:,}")

    def left_out(self, combinations: Sequence[Combination], reason: str) -> None:
        self._say(f"left out: {count(len(combinations), 'combination')}, because {reason}")

    def planned(self, total: int, present: int) -> None:
        self.total, self.done = total, present
        self._began = self._drawn = time.monotonic()
        if present:
            self._say(f"{present} of {total} models already exist")

    def without_reference(self, reference: Combination, reason: str) -> None:
        self._say(f"no distances between clouds: {reference} has no model ({reason})")

    def working(self, activities: Sequence[Doing]) -> None:
        now = time.monotonic()
        if self.status and now - self._drawn >= SECONDS_BETWEEN_DRAWINGS:
            self._drawn = now
            self.status.update("; ".join(str(call) for call, _ in activities if call))
        elif not self.status and now - self._drawn >= LONGEST_SILENCE:
            self._drawn = now
            calls = "; ".join(str(call) for call, _ in activities if call)
            self._say(f"{self.done} of {self.total}, {spoken_seconds(now - self._began)}: {calls}")

    def finished(self, row: Row) -> None:
        self.done += 1
        self._drawn = time.monotonic()
        name = name_in_row(row)
        self._say(f"{self.done} of {self.total}  {name}  {summary(row)}")

    def _say(self, line: str) -> None:
        if self.status:
            self.status.console.print(line, soft_wrap=True, markup=False)
        else:
            sys.stderr.write(f"{line}\n")
            sys.stderr.flush()


def summary(row: Row) -> str:
    """``ok: 18 of 18 images, 1,288 points, 0.34 px, 0.8 m``, or only the status of a failure.

    The reasons, which may be long, follow below the final table.
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


@contextlib.contextmanager
def reporter() -> Iterator[Reporter]:
    """The display for standard error: a live line on a terminal, plain lines elsewhere."""
    if not sys.stderr.isatty():
        yield Reporter()
        return
    from rich.console import Console

    console = Console(stderr=True, highlight=False)
    with console.status("reading images") as status:
        yield Reporter(status=status)
