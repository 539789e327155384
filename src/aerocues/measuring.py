"""The functions that make results, as users of the library call them."""

from __future__ import annotations

from functools import wraps
from pathlib import Path

from aerocues.evaluation import importing
from aerocues.evaluation import run as running
from aerocues.results import Results, giving_results

run = giving_results(running.run)


@wraps(importing.import_results)
def import_results(
    file: str | Path,
    output: str | Path,
    *,
    reconstruction: str | Path | None = None,
    dataset: str | None = None,
    platform: str | None = None,
) -> list[Results]:
    """Make results folders of a table of measurements; see `importing.import_results`."""
    made = importing.import_results(
        file, output, reconstruction=reconstruction, dataset=dataset, platform=platform
    )
    return [Results(each.folder) for each in made]
