"""The display on a terminal: redrawn in place, gone when the work is over."""

from __future__ import annotations

import contextlib
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from aerocues.cli.progress import Tally, waiting
from aerocues.cli.wording import in_options
from aerocues.phrases import spoken_seconds
from aerocues.progress import Event
from aerocues.standard_error import tell

if TYPE_CHECKING:
    from rich.console import Group
    from rich.live import Live
    from rich.text import Text

# Drawing takes milliseconds of a core that a worker could use.
SECONDS_BETWEEN_DRAWINGS = 0.5
SECONDS_BETWEEN_TICKS = 1.0
BAR_WIDTH = 30


@dataclass
class LiveDisplay(Tally):
    """Draws what each worker runs, what is done, the time left and how rows ended."""

    live: Live | None = None
    _drawn: float = field(default=float("-inf"))

    def __call__(self, event: Event) -> None:
        begins = event.stage != self.event.stage
        super().__call__(event)
        if self.live is None:
            return
        if event.message and event.message != event.standing:  # stays above the display
            self.live.console.print(in_options(event.message), soft_wrap=True, markup=False)
        self._draw(at_once=begins or bool(event.message))

    def tick(self) -> None:
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

        event = self.event
        lines: list[Text] = list(self._workers())
        if self.statuses:
            lines.append(Text(f"so far    {self.outcomes()}", style="dim"))
        if event.standing or not event.total:
            return Group(
                Text(self.stands() if event.ends else event.standing or event.stage), *lines
            )
        done = event.done / event.total
        bar_and_figures = Table.grid(padding=(0, 2))
        bar_and_figures.add_row(
            ProgressBar(total=1.0, completed=done, width=BAR_WIDTH),
            Text(
                self.stands() if event.ends else f"{event.stage}: {self.progress()}",
                no_wrap=True,
                overflow="ellipsis",
            ),
        )
        return Group(bar_and_figures, *lines)

    def _workers(self) -> Iterator[Text]:
        from rich.text import Text

        for activity in self.event.workers:
            if activity.waiting_for:
                yield Text(waiting(activity), style="dim")
                continue
            what = activity.call.brief() if activity.call else "between two calls"
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
    """Show how work goes on: live on a terminal, in plain lines elsewhere.

    Raises
    ------
    typer.Exit
        If it is interrupted; what is finished is told.
    """
    import typer

    from aerocues.cli.interruption import Interrupted

    tally: Tally | None = None
    try:
        with _suitable() as tally, _ticking(tally):
            yield tally
    except Interrupted as interruption:
        kept = f"; {tally.kept()}" if tally and tally.kept() else ""
        tell(f"interrupted{kept}; run the same command again to continue\n")
        raise typer.Exit(interruption.exit_code) from None


@contextlib.contextmanager
def _ticking(tally: Tally) -> Iterator[None]:
    """Let a display tell how things stand also while nothing happens."""
    over = threading.Event()

    def tick() -> None:
        while not over.wait(SECONDS_BETWEEN_TICKS):
            tally.tick()

    thread = threading.Thread(target=tick, daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


@contextlib.contextmanager
def _suitable() -> Iterator[Tally]:
    from aerocues.cli.progress import PlainLines

    if not sys.stderr.isatty():
        yield PlainLines()
        return
    from rich.console import Console
    from rich.live import Live

    console = Console(stderr=True, highlight=False)
    with Live(console=console, auto_refresh=False, transient=True) as live:
        yield LiveDisplay(live=live)
