"""Options that the scoring commands have in common."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from aerocues.scoring.measured import Measured, MeasuredTable
    from aerocues.scoring.settings import ScoreSettings


class Failures(StrEnum):
    """Values of ``--failures``."""

    WORST = "worst"
    OMIT = "omit"


class Test(StrEnum):
    """Values of ``--test``."""

    BOOTSTRAP = "bootstrap"
    WILCOXON = "wilcoxon"


AllLatexOption = Annotated[
    str | None, typer.Option("--latex", metavar="FILE", help="Write all tables as LaTeX.")
]
AllMarkdownOption = Annotated[
    str | None, typer.Option("--markdown", metavar="FILE", help="Write all tables as Markdown.")
]
PresetOption = Annotated[
    str | None,
    typer.Option(
        "--preset",
        metavar="NAME",
        help="Scoring preset, such as default or thesis (all in docs/scoring.md); by default the "
        "one that suits the results.",
    ),
]
CriteriaOption = Annotated[
    str | None,
    typer.Option(
        "--criteria",
        metavar="NAMES",
        help="Criteria, such as precision,inliers (all in docs/scoring.md); by default those of "
        "the preset.",
    ),
]
ReconstructionOption = Annotated[
    bool | None,
    typer.Option(
        "--reconstruction/--no-reconstruction",
        help="Also score the 3D models; by default if most combinations have one.",
        show_default=False,
    ),
]
FailuresOption = Annotated[
    Failures | None,
    typer.Option(
        "--failures",
        help="Count failed pairs as the worst value, or omit them; by default as in the preset.",
    ),
]
AlphaOption = Annotated[
    float | None,
    typer.Option(
        "--alpha", metavar="POWER", help="Exponent of the normalised values; by default 0.5."
    ),
]
WeightsOption = Annotated[
    str | None,
    typer.Option(
        "--weights",
        metavar="NAMES",
        help="Weighting methods, such as entropy,critic (all in docs/scoring.md); by default "
        "those of the preset.",
    ),
]
AggregationOption = Annotated[
    str | None,
    typer.Option(
        "--aggregation",
        metavar="HOW",
        help="Mean of the weights: arithmetic (the default), geometric, harmonic or trimmed.",
    ),
]
DatasetOption = Annotated[
    str | None,
    typer.Option("--dataset", metavar="NAME", help="Dataset to score, if the folder has several."),
]
SeedOption = Annotated[
    int, typer.Option("--seed", min=0, max=2**31 - 1, metavar="N", help="Seed of the resampling.")
]


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
    """The table to score and the settings, from the options."""
    from aerocues.scoring.measured import settings_from, table_of

    found = table_of(
        results,
        preset,
        criteria=criteria,
        dataset=dataset,
        reconstruction=reconstruction,
    )
    settings = settings_from(
        found.preset,
        failures=failures.value if failures else None,
        alpha=alpha,
        weights=weights,
        aggregation=aggregation,
    )
    return found, settings
