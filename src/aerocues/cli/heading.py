"""`--upright`: images turned to a common heading, in the commands that find features."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from aerocues.datasets.dataset import Dataset

UprightOption = Annotated[
    bool,
    typer.Option(
        "--upright", help="Turn images to a common heading, by quarters, before finding features."
    ),
]


def turned(images: Dataset, seed: int, output: Path | None, *, asked: bool) -> Dataset:
    """The images, turned if that is asked for; a survey is kept in the results folder `output`."""
    if not asked:
        return images
    from aerocues.pipeline.upright import upright
    from aerocues.results.store import Store

    folder = None if output is None else Store.create(output).surveys
    return upright(images, seed=seed, folder=folder)
