"""`aerocues score`: ranks the combinations of measured results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aerocues.arguments import check_choice
from aerocues.cli.limit_options import (
    LicenceOption,
    Limits,
    MaxBytesOption,
    MaxMemoryOption,
    MaxSecondsOption,
    Objective,
)
from aerocues.cli.options import JsonOption, ResultsArgument, TopOption, given_options
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
from aerocues.errors import ArgumentError

if TYPE_CHECKING:
    from aerocues.scoring.ranking import Ranking

# Of what a paper has room for.
PRINTED = ("rank", "combination", "score", "score_low", "score_high", "rank_low", "rank_high")

# What an objective and limits leave without effect.
OF_CUES = {
    *("preset", "criteria", "failures", "alpha", "weights", "aggregation", "reconstruction"),
    *("interval", "test", "against", "top_k", "columns"),
}


class Interval(StrEnum):
    """Values of ``--interval``."""

    JOINT = "joint"
    PAIRWISE = "pairwise"


def score(
    context: typer.Context,
    folder: ResultsArgument,
    objective: Annotated[
        Objective | None,
        typer.Option(help="Rank for a purpose, as 'aerocues recommend' does, in place of CUES."),
    ] = None,
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
    test: Annotated[Test, typer.Option(help="Significance test.")] = Test.BOOTSTRAP,
    against: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Combination that the others are tested against, such as your own; by default the "
            "best.",
        ),
    ] = None,
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
    columns: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="Columns of these two, such as rank,combination,score,p_value (names as in CSV).",
        ),
    ] = None,
    max_seconds_per_image: MaxSecondsOption = None,
    max_memory: MaxMemoryOption = None,
    max_descriptor_bytes: MaxBytesOption = None,
    licence: LicenceOption = None,
) -> None:
    """Rank combinations by CUES or for a purpose, with intervals."""
    targets = {"csv": csv, "latex": latex, "markdown": markdown}
    limits = Limits(max_seconds_per_image, max_memory, max_descriptor_bytes, licence)
    if objective is not None or limits.given():
        _refuse_settings(context)
        drawn = {"dataset": dataset, "resamples": resamples, "seed": seed}
        _for_purpose(folder, objective, {**limits.given(), **drawn}, targets, top, as_json=as_json)
        return
    if columns is not None:
        from aerocues.scoring.settings import names_of

        _check_columns(names_of(columns), latex or markdown)
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
            against=against,
        )
    _write(ranking, targets, top, columns)
    if STANDARD_OUTPUT in targets.values():
        return
    if as_json:
        print_json(facts(ranking, measured))
    else:
        print_scores(ranking, measured, top)


def _refuse_settings(context: typer.Context) -> None:
    """Raise a usage error where something was given that only CUES takes."""
    for name, written in given_options(context).items():
        if name in OF_CUES:
            raise typer.BadParameter(
                f"{written} is for CUES, not for an objective or limits; leave it out"
            )


def _check_columns(names: Sequence[str], target: str | None) -> None:
    if target is None:
        raise ArgumentError("`columns` are those of --latex and --markdown; give one of the two")
    if not names:
        raise ArgumentError("`columns` must name one column or more, such as rank,combination")
    if doubled := sorted({name for name in names if names.count(name) > 1}):
        raise ArgumentError(f"`columns` must name each column once, got {doubled[0]!r} twice")


def _for_purpose(
    folder: Path,
    objective: Objective | None,
    settings: Mapping[str, Any],
    targets: Mapping[str, str | None],
    top: int,
    *,
    as_json: bool,
) -> None:
    import aerocues
    from aerocues.cli.choice_table import choice_facts, print_choice
    from aerocues.cli.interruption import interruptible

    with interruptible():
        found = aerocues.choose(folder, (objective or Objective.EFFICIENCY).value, **settings)
    for form, target in targets.items():
        if target is not None:
            frame = found.ranked if form == "csv" else found.ranked.head(top)
            write_table(frame, target, form, "combination")
    if STANDARD_OUTPUT in targets.values():
        return
    if as_json:
        print_json(choice_facts(found))
    else:
        print_choice(found, top)


def _write(ranking: Ranking, targets: dict[str, str | None], top: int, columns: str | None) -> None:
    from aerocues.scoring.settings import names_of

    frame = ranking.frame("combination")
    criteria = ranking.scores.table.criterion_names
    names = names_of(columns) if columns else [*PRINTED, "success_rate", *criteria]
    for name in names:
        check_choice("columns", name, frame.columns)
    printed = frame.select(names).head(top)
    for form, target in targets.items():
        if target is not None:
            write_table(frame if form == "csv" else printed, target, form, "combination")
