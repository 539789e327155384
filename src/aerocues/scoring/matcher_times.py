"""What each matcher costs against brute force, by detector and descriptor."""

from __future__ import annotations

from typing import TYPE_CHECKING

from aerocues.scoring.cues import Scores

if TYPE_CHECKING:
    import polars as pl

BASE = "BF"
BY = ("detectors", "descriptors", "norms")


def matcher_times(scores: Scores, criterion: str) -> dict[str, pl.DataFrame]:
    """Compare a cost of combinations that differ in their matcher alone.

    Parameters
    ----------
    scores : Scores
        Of a table with the components ``detectors, descriptors, norms, matchers``.
    criterion : str
        Such as ``seconds_per_1k_inliers``: each combination's mean over its pairs counts.

    Returns
    -------
    dict of pl.DataFrame
        For detectors, descriptors and norms, one row per name and matcher: ``name, matcher,
        combinations`` (measured with brute force, too), ``brute_force, other`` (medians over them)
        and ``ratio`` of the other to brute force (geometric mean). Empty without brute force.
    """
    import polars as pl

    table = scores.table
    if criterion not in table.criterion_names or not {*BY, "matchers"} <= table.components.keys():
        return {}
    frame = pl.DataFrame(
        {
            **{name: table.components[name] for name in (*BY, "matchers")},
            "cost": scores.means[:, table.criterion_names.index(criterion)],
        },
        nan_to_null=True,
    ).drop_nulls()
    base = frame.filter(pl.col("matchers") == BASE).drop("matchers")
    pairs = (
        frame.filter(pl.col("matchers") != BASE)
        .join(base, on=BY, suffix="_of_base")
        .filter(pl.col("cost") > 0, pl.col("cost_of_base") > 0)
    )
    if pairs.is_empty():
        return {}
    return {component: _by(pairs, component) for component in BY}


def _by(pairs: pl.DataFrame, component: str) -> pl.DataFrame:
    import polars as pl

    return (
        pairs.group_by(pl.col(component).alias("name"), pl.col("matchers").alias("matcher"))
        .agg(
            pl.len().alias("combinations"),
            pl.col("cost_of_base").median().alias("brute_force"),
            pl.col("cost").median().alias("other"),
            (pl.col("cost") / pl.col("cost_of_base")).log().mean().exp().alias("ratio"),
        )
        .sort("matcher", "ratio", "name")
    )
