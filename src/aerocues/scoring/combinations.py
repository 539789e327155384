"""Combinations of detector, descriptor, norm and matcher as a decision table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import polars as pl

from aerocues.errors import ScoreError
from aerocues.results.combination_columns import COMBINATION, METHODS, combination_name
from aerocues.results.pair_classes import pair_class
from aerocues.scoring.criteria import RIGHT_MATCHES, Criterion
from aerocues.scoring.links import ENOUGH, Links
from aerocues.scoring.settings import ScorePreset, score_preset_named
from aerocues.scoring.table import DecisionTable

PAIR = ("dataset", "sequence", "image_1", "image_2", "pair")
# What is known of a pair, whatever became of a measurement on it.
OF_PAIRS = ("reference_agreement", "reference_turn")
REFERENCE = "flow"
# By what scores are grouped: the plural, and the methods that make a label.
COMPONENTS: dict[str, tuple[str, ...]] = {
    "detectors": ("detector",),
    "descriptors": ("descriptor",),
    "detector-descriptor pairs": ("detector", "descriptor"),
    "norms": ("norm",),
    "matchers": ("matcher",),
}
SUCCESS = ("ok",)
SUCCESS_WITHOUT_CHANCE_TEST = ("ok", "chance")


def has_chance_test(rows: pl.DataFrame) -> bool:
    """Whether inliers beyond chance were measured."""
    return "chance_inliers" in rows.columns and rows["chance_inliers"].is_not_null().any()


def has_reference(rows: pl.DataFrame) -> bool:
    """Whether some pair has a reference that tells right matches."""
    return "reference" in rows.columns and bool((rows["reference"] == REFERENCE).any())


def suitable_preset(rows: pl.DataFrame) -> ScorePreset:
    """The default where most pairs have a reference; else inliers beyond chance, or the thesis's.

    Pairs on which nothing succeeds, such as those of images without overlap, need none.
    """
    if has_reference(rows):
        having = pl.col("reference") == REFERENCE
        known = rows.filter(having)["pair"].n_unique()
        of = rows.filter(having.fill_null(False) | pl.col("status").is_in(SUCCESS))[
            "pair"
        ].n_unique()
        if 2 * known >= of:
            return score_preset_named("default")
    return score_preset_named("inliers" if has_chance_test(rows) else "thesis")


def decision_table(
    rows: pl.DataFrame,
    criteria: Sequence[Criterion],
    *,
    reconstructions: pl.DataFrame | None = None,
    chance_fails: bool = True,
    links: bool = False,
) -> DecisionTable:
    """Arrange measured rows: combinations x image pairs x criteria.

    Parameters
    ----------
    rows : pl.DataFrame
        One row per pair and combination of one dataset: ``detector, descriptor, norm, matcher,
        pair, status`` and the columns of the criteria; ``sequence`` if there are several.
    criteria : sequence of Criterion
    reconstructions : pl.DataFrame, optional
        One row per combination, with ``status`` and the columns of the criteria of reconstruction.
        A combination without a row was not reconstructed and has no score by these criteria.
    chance_fails : bool
        Whether a pair with the status ``chance`` has failed.
    links : bool
        Whether scores are multiplied by how surely pairs of each class are linked.

    Pairs without a reference are left out, for all combinations alike, where links or a criterion
    need one.

    Raises
    ------
    ScoreError
        If there are no rows, they belong to several datasets, or a column is missing.
    """
    if rows.is_empty():
        raise ScoreError("there are no measured rows; measure some with `aerocues.run`")
    datasets = rows["dataset"].unique().sort().to_list()
    if len(datasets) > 1:
        raise ScoreError(
            f"the rows belong to several datasets; choose one of {', '.join(datasets)}"
        )
    by_pair = [criterion for criterion in criteria if not criterion.reconstruction]
    if not by_pair:
        raise ScoreError("all criteria are of the reconstruction; add one of the image pairs")
    if links or any(criterion.reference for criterion in criteria):
        rows = _with_reference(rows)
    succeeded = SUCCESS if chance_fails else SUCCESS_WITHOUT_CHANCE_TEST
    named = _named(_without_failures(rows, succeeded))
    table = DecisionTable.from_frame(
        named,
        alternative=COMBINATION,
        repeat="pair",
        block="sequence",
        criteria=by_pair,
    )
    labels = [name.split("-") for name in table.alternatives]
    table = replace(
        table,
        components={
            component: tuple(
                "-".join(parts[METHODS.index(method)] for method in methods) for parts in labels
            )
            for component, methods in COMPONENTS.items()
        },
        links=_links(named, table) if links else None,
    )
    of_models = [criterion for criterion in criteria if criterion.reconstruction]
    if not of_models:
        return table
    if reconstructions is None or reconstructions.is_empty():
        names = ", ".join(criterion.name for criterion in of_models)
        raise ScoreError(f"there are no reconstructions for {names}; leave these criteria out")
    return _with_reconstructions(table, reconstructions, of_models, criteria)


def _with_reference(rows: pl.DataFrame) -> pl.DataFrame:
    if not has_reference(rows):
        raise ScoreError(
            "no pair has a reference, which tells right matches; score by inliers (preset inliers)"
        )
    # A row of a pair with a reference lacks it where its measurement ended before the comparison.
    having = rows.filter(pl.col("reference") == REFERENCE).select("pair").unique()
    return rows.join(having, on="pair", how="semi", maintain_order="left")


def _links(rows: pl.DataFrame, table: DecisionTable) -> Links:
    """How surely each combination links each pair, and whether the pair is turned."""
    share = np.full((len(table.alternatives), len(table.repeats)), np.nan)
    alternative = {name: number for number, name in enumerate(table.alternatives)}
    repeat = {name: number for number, name in enumerate(table.repeats)}
    right = rows[RIGHT_MATCHES].cast(pl.Float64).fill_null(0.0).to_numpy()
    positions = (
        [alternative[name] for name in rows[COMBINATION]],
        [repeat[str(pair)] for pair in rows["pair"]],
    )
    share[positions] = np.minimum(right / ENOUGH, 1.0)
    turns = rows.group_by("pair").agg(pl.col("reference_turn").max().fill_null(0.0))
    turned = {str(pair): pair_class(turn) == "turned" for pair, turn in turns.iter_rows()}
    return Links(share, np.array([turned[name] for name in table.repeats], np.int64))


def _named(rows: pl.DataFrame) -> pl.DataFrame:
    name = combination_name()
    sequence = pl.col("sequence").fill_null("") if "sequence" in rows.columns else pl.lit("")
    return rows.with_columns(name, sequence.alias("sequence")).sort("pair", COMBINATION)


def _without_failures(rows: pl.DataFrame, succeeded: Sequence[str]) -> pl.DataFrame:
    """The rows; numbers of failed rows are null."""
    numbers = [
        name
        for name, kind in rows.schema.items()
        if kind.is_numeric() and name not in (*METHODS, *PAIR, *OF_PAIRS)
    ]
    kept = pl.col("status").is_in(succeeded)
    return rows.with_columns(pl.when(kept).then(pl.col(numbers)))


def _with_reconstructions(
    table: DecisionTable,
    reconstructions: pl.DataFrame,
    of_models: Sequence[Criterion],
    criteria: Sequence[Criterion],
) -> DecisionTable:
    models = DecisionTable.from_frame(
        _without_failures(reconstructions, SUCCESS).with_columns(combination_name()),
        alternative=COMBINATION,
        criteria=of_models,
    )
    position = {name: number for number, name in enumerate(models.alternatives)}
    found = [position.get(name, -1) for name in table.alternatives]
    known = np.array(found) >= 0
    if not known.any():
        raise ScoreError("none of the combinations was reconstructed; leave these criteria out")
    shape = (len(table.alternatives), len(table.repeats), len(of_models))
    values = np.where(known[:, None, None], models.values[found], np.nan)
    failed = known[:, None, None] & models.failed[found]
    order = [*(each for each in criteria if not each.reconstruction), *of_models]
    return replace(
        table,
        criteria=tuple(order),
        values=np.concatenate([table.values, np.broadcast_to(values, shape)], axis=2),
        failed=np.concatenate([table.failed, np.broadcast_to(failed, shape)], axis=2),
    )
