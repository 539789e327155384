"""The option `--live`: the report page of a results folder while a command fills it."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from aerocues.cli.progress import Tally
    from aerocues.progress import Event, Progress

LiveOption = Annotated[
    bool,
    typer.Option("--live", help="Serve the report page to a browser here while results come in."),
]


@contextlib.contextmanager
def display_and_page(folder: Path, *, live: bool) -> Iterator[tuple[Tally, Progress]]:
    """Show how work goes on, as `live.display`; and on a page, whose address is told.

    Parameters
    ----------
    folder : Path
        Results folder; it need not exist yet.
    live : bool
        Whether the page is served.
    """
    from aerocues.cli.live import display

    if not live:
        with display() as tally:
            yield tally, tally
        return
    from aerocues.report.live import LivePage, Serving, page_of_folder

    page = LivePage(folder, page_of_folder)
    with Serving(page) as serving:
        sys.stderr.write(f"live     {serving.address}\n")
        sys.stderr.flush()
        with display() as tally:

            def both(event: Event) -> None:
                tally(event)
                page(event)

            page.tell = lambda: told(tally)
            yield tally, both


def told(tally: Tally) -> str:
    """Stage and how things stand, for the line of the page."""
    if tally.began is None:
        return "starting"
    stage, stands = tally.event.stage, tally.stands()
    return stands if stands.startswith(stage) else f"{stage}: {stands}"
