"""`aerocues compare`: rankings across datasets, runs over the same images."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from aerocues.cli.options import JsonOption, ResultsArguments, TopOption
from aerocues.cli.output import STANDARD_OUTPUT, print_json, write_table, write_tables
from aerocues.cli.scoring import (
    AggregationOption,
    AllLatexOption,
    AllMarkdownOption,
    AlphaOption,
    CriteriaOption,
    FailuresOption,
    PresetOption,
    SeedOption,
    Test,
    WeightsOption,
)

if TYPE_CHECKING:
    import polars as pl

    from aerocues.scoring.compared import ComparedResults, Runs
    from aerocues.scoring.overview import Overview
    from aerocues.scoring.platform_scores import PlatformScores


class Over(StrEnum):
    """Values of ``--over``."""

    PAIRWISE = "pairwise"
    ALL = "all"


def compare(
    results: ResultsArguments,
    preset: PresetOption = None,
    criteria: CriteriaOption = None,
    failures: FailuresOption = None,
    alpha: AlphaOption = None,
    weights: WeightsOption = None,
    aggregation: AggregationOption = None,
    reconstruction: Annotated[
        bool,
        typer.Option(
            "--reconstruction", help="Also score the 3D models of datasets that have some."
        ),
    ] = False,
    over: Annotated[
        Over,
        typer.Option(
            help="Compare combinations that are scored in both of two results, or in all."
        ),
    ] = Over.PAIRWISE,
    test: Annotated[
        Test, typer.Option(help="Paired test of two runs over the same images.")
    ] = Test.BOOTSTRAP,
    seed: SeedOption = 0,
    top: TopOption = 15,
    as_json: JsonOption = False,
    csv: Annotated[
        str | None,
        typer.Option(
            metavar="FILE", help="Write one row per combination as CSV; - is standard output."
        ),
    ] = None,
    latex: AllLatexOption = None,
    markdown: AllMarkdownOption = None,
    factors: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Write how much longer each stage takes in the second results than in the first, "
            "for 'recommend --device'.",
        ),
    ] = None,
) -> None:
    """Compare datasets, machines, or runs over the same images.

    Two runs over the same images, under two presets, versions or machines, are scored together,
    and every difference is tested.
    """
    import aerocues
    from aerocues.cli.comparison_tables import print_compared
    from aerocues.cli.interruption import interruptible

    with interruptible():
        found = aerocues.compare(
            results,
            preset,
            criteria=criteria,
            reconstruction=reconstruction,
            failures=failures.value if failures else None,
            alpha=alpha,
            weights=weights,
            aggregation=aggregation,
            over=over.value,
            test=test.value,
            seed=seed,
        )
        if factors is not None:
            _write_factors(found, factors)
    if csv is not None:
        write_table(found.frame(), csv, "csv", "combination")
    for form, target in (("latex", latex), ("markdown", markdown)):
        if target is not None:
            write_tables(_shortened(found.tables(), top), target, form)
    if STANDARD_OUTPUT in (csv, latex, markdown):
        return
    if as_json:
        print_json(_facts(found))
    else:
        print_compared(found, top, reconstruction=reconstruction)


def _shortened(tables: Mapping[str, pl.DataFrame], top: int) -> dict[str, pl.DataFrame]:
    """Lists of combinations have at most `top` rows; matrices and criteria stay whole."""
    return {
        title: table.head(top) if table.columns[0] == "combination" else table
        for title, table in tables.items()
    }


def _write_factors(found: ComparedResults, file: Path) -> None:
    from aerocues.results.export import write_file
    from aerocues.results.whole_files import json_content

    write_file(file, json_content(found.factors()))


def _facts(found: ComparedResults) -> dict[str, Any]:
    from aerocues.cli.validate import matrix_facts

    entries, comparison = found.entries, found.rankings
    return {
        "results": [
            {
                "name": each.name,
                "dataset": each.dataset,
                "machine": each.machine,
                "criteria": list(each.scores.table.criterion_names),
                "conditions": dict(each.conditions),
            }
            for each in entries
        ],
        "preset": entries[0].preset,
        "over": comparison.over,
        "spearman": matrix_facts(comparison.names, comparison.spearman()),
        "kendall": matrix_facts(comparison.names, comparison.kendall()),
        "shared": comparison.shared().tolist(),
        "versatility": comparison.versatility().rename({"alternative": "combination"}).to_dicts(),
        "overview": _overview_facts(found.overview),
        "runs": [_run_facts(each) for each in found.runs],
    }


def _overview_facts(found: Overview | None) -> dict[str, Any] | None:
    from aerocues.cli.validate import matrix_facts

    if found is None:
        return None
    return {
        "datasets": list(found.datasets),
        "evaluations": found.evaluations,
        "mean_correlation": found.mean_correlation,
        "mean_of_bests": found.mean_of_bests,
        "range_of_bests": found.range_of_bests,
        "best": found.best.to_dicts(),
        "kept_in_top": found.kept.tolist(),
        "consistent": found.consistent.rename({"alternative": "combination"}).to_dicts(),
        "hierarchies": {name: frame.to_dicts() for name, frame in found.hierarchies.items()},
        "alpha": matrix_facts(found.alpha.names, found.alpha.correlation),
        "aggregation": matrix_facts(found.aggregation.names, found.aggregation.correlation),
    }


def _run_facts(runs: Runs) -> dict[str, Any]:
    joint, times = runs.joint, runs.times
    told = (
        {"unavailable": joint}
        if isinstance(joint, str)
        else {
            "pairs": joint.pairs,
            "test": joint.test,
            "differences": joint.differences().to_dicts(),
            "criteria": joint.criteria().to_dicts(),
        }
    )
    return {
        "first": runs.first.name,
        "second": runs.second.name,
        **told,
        "times": times if isinstance(times, str) else times.to_dicts(),
        "machines": _machine_facts(runs.machines),
    }


def _machine_facts(found: PlatformScores | str | None) -> dict[str, Any] | str | None:
    if found is None or isinstance(found, str):
        return found
    return {
        "spearman": found.spearman,
        "kept_in_top": found.kept,
        "largest_difference": found.largest,
        "combinations": found.combinations.to_dicts(),
        "components": {name: frame.to_dicts() for name, frame in found.components.items()},
    }
