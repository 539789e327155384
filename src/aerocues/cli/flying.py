"""The progress of a flight: a bar, and what is told when it is interrupted."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from aerocues.simulation.flight import Flown, Progress


def show(title: str, total: int, fly: Callable[[Progress], Flown]) -> Flown:
    """Fly under a bar of progress.

    Parameters
    ----------
    title : str
    total : int
        Images.
    fly : callable
        Does the work, given what to call with the number of finished images and of all.

    Raises
    ------
    typer.Exit
        If it is interrupted; what is finished is there.
    """
    from rich.console import Console
    from rich.progress import Progress as Bars

    from aerocues.cli.interruption import Interrupted, interruptible

    finished = 0

    bars = Bars(console=Console(stderr=True))
    task = bars.add_task(title, total=total)

    def tell(done: int, of: int) -> None:
        nonlocal finished
        bars.start()  # what is wrong before the work begins is told without a bar
        finished = done
        bars.update(task, completed=done, total=of)

    try:
        with interruptible():
            try:
                return fly(tell)
            finally:
                if bars.live.is_started:
                    bars.stop()
    except Interrupted as interruption:
        kept = f"{finished} of {total} images are finished"
        sys.stderr.write(f"interrupted; {kept}; run the same command again to go on\n")
        raise typer.Exit(interruption.exit_code) from None
