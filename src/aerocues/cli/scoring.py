"""The options that all commands which score have in common."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from aerocues.scoring.measured import Measured, MeasuredTable
    from aerocues.scoring.settings import ScoreSettings


class Failures(StrEnum):
    """Values of ``--failures``."""

    WORST = "worst"
    OMIT = "omit"


ResultsArgument = Annotated[
    Path, typer.Argument(metavar="RESULTS", help="A results folder or a packed one.")
]
PresetOption = Annotated[
    str | None,
    typer.Option(
        "--preset", metavar="NAME", help="default or thesis; by default what suits the results."
    ),
]
CriteriaOption = Annotated[
    str | None,
    typer.Option(
        "--criteria",
        metavar="NAMES",
        help="Such as precision,inliers (docs/scoring.md lists all); by default those of the "
        "preset.",
    ),
]
ReconstructionOption = Annotated[
    bool | None,
    typer.Option(
        "--reconstruction/--no-reconstruction",
        help="Score the 3D models, too; by default if most combinations have one.",
        show_default=False,
    ),
]
FailuresOption = Annotated[
    Failures | None,
    typer.Option("--failures", help="What a failed pair counts as; by default as in the preset."),
]
AlphaOption = Annotated[
    float | None,
    typer.Option(
        "--alpha", metavar="POWER", help="Power of the normalised values; by default 0.5."
    ),
]
WeightsOption = Annotated[
    str | None,
    typer.Option(
        "--weights",
        metavar="NAMES",
        help="Such as entropy,critic (docs/scoring.md lists all); by default those of the preset.",
    ),
]
AggregationOption = Annotated[
    str | None,
    typer.Option(
        "--aggregation",
        metavar="HOW",
        help="arithmetic (the default), geometric, harmonic or trimmed.",
    ),
]
DatasetOption = Annotated[
    str | None,
    typer.Option("--dataset", metavar="NAME", help="Which, where the folder holds several."),
]
SeedOption = Annotated[
    int, typer.Option("--seed", min=0, max=2**31 - 1, metavar="N", help="Seed of the resampling.")
]


def named(names: str | None) -> tuple[str, ...] | None:
    """Names from a list with commas; None stays."""
    if names is None:
        return None
    return tuple(name.strip() for name in names.split(",") if name.strip())


def table_and_settings(
    results: Measured,
    *,
    preset: str | None,
    criteria: str | None,
    reconstruction: bool | None,
    dataset: str | None,
    failures: Failures | None = None,
    alpha: float | None = None,
    weights: str | None = None,
    aggregation: str | None = None,
) -> tuple[MeasuredTable, ScoreSettings]:
    """What is to be scored and how, from the options."""
    from aerocues.scoring.measured import settings_from, table_of

    found = table_of(
        results,
        preset,
        criteria=named(criteria),
        dataset=dataset,
        reconstruction=reconstruction,
    )
    settings = settings_from(
        found.preset,
        failures=failures.value if failures else None,
        alpha=alpha,
        weights=named(weights),
        aggregation=aggregation,
    )
    return found, settings
