"""`aerocues validate`: how robust a ranking is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from aerocues.cli.options import JsonOption, ResultsArgument
from aerocues.cli.output import STANDARD_OUTPUT, print_json, write_tables
from aerocues.cli.scoring import (
    AggregationOption,
    AllLatexOption,
    AllMarkdownOption,
    AlphaOption,
    CriteriaOption,
    DatasetOption,
    FailuresOption,
    PresetOption,
    ReconstructionOption,
    SeedOption,
    WeightsOption,
)

if TYPE_CHECKING:
    from aerocues.scoring.cues import Scores
    from aerocues.scoring.outcomes import Relations
    from aerocues.scoring.validation import Validation


def validate(
    folder: ResultsArgument,
    preset: PresetOption = None,
    criteria: CriteriaOption = None,
    failures: FailuresOption = None,
    alpha: AlphaOption = None,
    weights: WeightsOption = None,
    aggregation: AggregationOption = None,
    reconstruction: ReconstructionOption = None,
    dataset: DatasetOption = None,
    speed: Annotated[
        str | None, typer.Option(metavar="CRITERION", help="First axis of the Pareto front.")
    ] = None,
    quality: Annotated[
        str | None, typer.Option(metavar="CRITERION", help="Second axis of the Pareto front.")
    ] = None,
    seed: SeedOption = 0,
    top: Annotated[int, typer.Option(min=2, metavar="N", help="Length of the lists.")] = 10,
    as_json: JsonOption = False,
    csv: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="Write all tables as one CSV, a row for each value."),
    ] = None,
    latex: AllLatexOption = None,
    markdown: AllMarkdownOption = None,
) -> None:
    """Show how robust the ranking is.

    How it changes with each setting, how other decision methods rank the same values, and which
    criteria drive it.
    """
    import aerocues
    from aerocues.cli.interruption import interruptible
    from aerocues.cli.relations_table import found_relations, print_relations, relation_facts
    from aerocues.cli.scoring import table_and_settings
    from aerocues.cli.validation_tables import print_validation
    from aerocues.scoring.cues import score
    from aerocues.scoring.measured import MeasuredRows
    from aerocues.scoring.validation import validate as examine

    with interruptible():
        stored = aerocues.Results(folder)
        results = MeasuredRows(stored.table(), stored.reconstructions())
        measured, settings = table_and_settings(
            results,
            preset=preset,
            criteria=criteria,
            reconstruction=reconstruction,
            dataset=dataset,
            failures=failures,
            alpha=alpha,
            weights=weights,
            aggregation=aggregation,
        )
        scores = score(measured.table, settings)
        found = examine(scores, speed=speed, quality=quality, shortlist=top, seed=seed)
        relations = found_relations(results, preset, measured.dataset)
    targets = {"csv": csv, "latex": latex, "markdown": markdown}
    _write(found, relations, targets, top)
    if STANDARD_OUTPUT in targets.values():
        return
    if as_json:
        print_json({**_facts(scores, found), "reconstruction": relation_facts(relations)})
        return
    print_validation(scores, found, measured, top)
    if len(results.reconstructions()):
        print_relations(relations)


def _write(
    found: Validation, relations: Relations | str, targets: dict[str, str | None], top: int
) -> None:
    from aerocues.cli.relations_table import relations_table

    if not any(targets.values()):
        return
    tables = found.tables(top)
    if not isinstance(relations, str):
        tables["Pairs and 3D models"] = relations_table(relations)
    for form, target in targets.items():
        if target is not None:
            write_tables(tables, target, form)


def _facts(scores: Scores, found: Validation) -> dict[str, Any]:
    names = scores.table.alternatives
    facts: dict[str, Any] = {
        "alpha": matrix_facts(found.alpha.names, found.alpha.correlation, found.alpha.best),
        "aggregation": matrix_facts(
            found.aggregation.names, found.aggregation.correlation, found.aggregation.best
        ),
        "criterion_left_out": matrix_facts(
            found.criterion_left_out.names,
            found.criterion_left_out.correlation,
            found.criterion_left_out.best,
        ),
        "criteria_correlation": matrix_facts(
            scores.table.criterion_names, found.criteria_correlation
        ),
        "hierarchies": {name: frame.to_dicts() for name, frame in found.hierarchies.items()},
        "matcher_times": {name: frame.to_dicts() for name, frame in found.matcher_times.items()},
        "pareto": {
            "criteria": found.pareto_criteria,
            "front": [names[position] for position in found.pareto_front],
        },
        "rank_reversal": vars(found.rank_reversal) if found.rank_reversal else None,
    }
    if isinstance(found.agreement, str):
        facts["agreement"] = found.agreement
    else:
        each = found.agreement
        facts["agreement"] = matrix_facts(each.names, each.correlation, each.best)
    if isinstance(found.critical_difference, str):
        facts["critical_difference"] = found.critical_difference
    else:
        ranked = vars(found.critical_difference)
        facts["critical_difference"] = {
            **ranked,
            "mean_ranks": found.critical_difference.mean_ranks.tolist(),
        }
    return facts


def matrix_facts(names: Any, values: Any, best: Any = None) -> dict[str, Any]:
    """A matrix with its names, as plain lists."""
    return {
        "names": list(names),
        "correlation": values.tolist(),
        **({"best": list(best)} if best else {}),
    }
