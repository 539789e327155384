"""`aerocues score`: ranks the combinations of measured results."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

from aerocues.cli.options import JsonOption, ResultsArgument, TopOption
from aerocues.cli.output import STANDARD_OUTPUT, print_json, write_table
from aerocues.cli.scoring import (
    AggregationOption,
    AlphaOption,
    CriteriaOption,
    DatasetOption,
    FailuresOption,
    PresetOption,
    ReconstructionOption,
    SeedOption,
    Test,
    WeightsOption,
)
from aerocues.defaults import RESAMPLES, TOP_K

if TYPE_CHECKING:
    from aerocues.scoring.ranking import Ranking

# Of what a paper has room for.
PRINTED = ("rank", "combination", "score", "score_low", "score_high", "rank_low", "rank_high")


class Interval(StrEnum):
    """Values of ``--interval``."""

    JOINT = "joint"
    PAIRWISE = "pairwise"


def score(
    folder: ResultsArgument,
    preset: PresetOption = None,
    criteria: CriteriaOption = None,
    failures: FailuresOption = None,
    alpha: AlphaOption = None,
    weights: WeightsOption = None,
    aggregation: AggregationOption = None,
    reconstruction: ReconstructionOption = None,
    dataset: DatasetOption = None,
    resamples: Annotated[
        int, typer.Option(min=2, metavar="N", help="Number of bootstrap resamples.")
    ] = RESAMPLES,
    seed: SeedOption = 0,
    interval: Annotated[
        Interval,
        typer.Option(help="Score interval: joint resampling, or pairwise as in the thesis."),
    ] = Interval.JOINT,
    test: Annotated[
        Test, typer.Option(help="Significance test against the best.")
    ] = Test.BOOTSTRAP,
    top: TopOption = 15,
    top_k: Annotated[
        int,
        typer.Option(
            min=1, metavar="K", help="Number of first places that probability_top counts."
        ),
    ] = TOP_K,
    as_json: JsonOption = False,
    csv: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="Write the whole ranking as CSV; - is standard output."),
    ] = None,
    latex: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write the best N as a LaTeX table.")
    ] = None,
    markdown: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write the best N as a Markdown table.")
    ] = None,
) -> None:
    """Rank combinations by CUES, with uncertainty intervals."""
    import aerocues
    from aerocues.cli.interruption import interruptible
    from aerocues.cli.ranking_table import facts, print_scores
    from aerocues.cli.scoring import table_and_settings
    from aerocues.scoring.ranking import rank_alternatives

    with interruptible():
        measured, settings = table_and_settings(
            aerocues.Results(folder),
            preset=preset,
            criteria=criteria,
            reconstruction=reconstruction,
            dataset=dataset,
            failures=failures,
            alpha=alpha,
            weights=weights,
            aggregation=aggregation,
        )
        ranking = rank_alternatives(
            measured.table,
            settings,
            resamples=resamples,
            seed=seed,
            interval=interval.value,
            test=test.value,
            top_k=top_k,
        )
    targets = {"csv": csv, "latex": latex, "markdown": markdown}
    _write(ranking, targets, top)
    if STANDARD_OUTPUT in targets.values():
        return
    if as_json:
        print_json(facts(ranking, measured))
    else:
        print_scores(ranking, measured, top)


def _write(ranking: Ranking, targets: dict[str, str | None], top: int) -> None:
    frame = ranking.frame("combination")
    criteria = ranking.scores.table.criterion_names
    printed = frame.select(*PRINTED, "success_rate", *criteria).head(top)
    for form, target in targets.items():
        if target is not None:
            write_table(frame if form == "csv" else printed, target, form, "combination")
