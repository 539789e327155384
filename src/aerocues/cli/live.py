"""The display of a run on a terminal: redrawn in place, gone when the run is over."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from aerocues.cli.progress import PlainLines, Tally, left_out, spoken_seconds, told_aside, waiting
from aerocues.evaluation.engine import Activity, Finished
from aerocues.evaluation.plan import Plan
from aerocues.results.timing import Timing

if TYPE_CHECKING:
    from rich.console import Group
    from rich.live import Live
    from rich.text import Text

# Drawing takes milliseconds of a core that a worker could use.
SECONDS_BETWEEN_DRAWINGS = 0.5
BAR_WIDTH = 30


@dataclass
class LiveDisplay(Tally):
    """Draws what each worker runs, the rows done, the time left and how pairs ended."""

    live: Live | None = None
    _activities: Sequence[Activity] = ()
    _hashing: str = "reading images"
    _drawn: float = field(default=float("-inf"))

    def hashing(self, done: int, total: int) -> None:
        self._hashing = f"reading images: {done:,} of {total:,}"
        self._draw(at_once=done == total)

    def set_aside(self, rows: int) -> None:
        if self.live:
            self.live.console.print(told_aside(rows), soft_wrap=True, markup=False)

    def planned(self, plan: Plan, timing: Timing) -> None:
        first = self.plan is None
        super().planned(plan, timing)
        if self.live and first:
            for line in left_out(plan):  # stays above the display
                self.live.console.print(line, soft_wrap=True, markup=False)
        self._draw(at_once=True)

    def working(self, activities: Sequence[Activity]) -> None:
        self._activities = activities
        self._draw()

    def finished(self, finished: Finished) -> None:
        super().finished(finished)
        self._draw()

    def _draw(self, *, at_once: bool = False) -> None:
        now = self.clock()
        if self.live and (at_once or now - self._drawn >= SECONDS_BETWEEN_DRAWINGS):
            self._drawn = now
            self.live.update(self.picture(), refresh=True)

    def picture(self) -> Group:
        """What is shown now."""
        from rich.console import Group
        from rich.progress_bar import ProgressBar
        from rich.table import Table
        from rich.text import Text

        if self.plan is None:
            return Group(Text(self._hashing, style="dim"))
        bar = ProgressBar(total=1.0, completed=self.share, width=BAR_WIDTH)
        bar_and_figures = Table.grid(padding=(0, 2))
        bar_and_figures.add_row(bar, Text(self.progress(), no_wrap=True, overflow="ellipsis"))
        lines = list(self._workers())
        if self.statuses:
            lines.append(Text(f"so far    {self.outcomes()}", style="dim"))
        return Group(bar_and_figures, *lines)

    def _workers(self) -> Iterator[Text]:
        from rich.text import Text

        for activity in self._activities:
            if activity.waiting_for:
                yield Text(waiting(activity), style="dim")
                continue
            what = str(activity.call) if activity.call else "between two units"
            seconds = spoken_seconds(activity.seconds) if activity.seconds >= 1 else ""
            yield Text.assemble(
                (f"worker {activity.worker + 1}  ", "dim"),
                f"{what}  ",
                (seconds, "dim"),
                no_wrap=True,
                overflow="ellipsis",
            )


@contextlib.contextmanager
def display() -> Iterator[Tally]:
    """The display that suits standard error: live on a terminal, plain lines elsewhere."""
    if not sys.stderr.isatty():
        yield PlainLines()
        return
    from rich.console import Console
    from rich.live import Live

    console = Console(stderr=True, highlight=False)
    with Live(console=console, auto_refresh=False, transient=True) as live:
        yield LiveDisplay(live=live)
