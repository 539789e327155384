"""Who builds models at the end of a race: the leaders, and the best on turned pairs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from aerocues.methods.combination import Combination
from aerocues.results.combination_columns import COMBINATION, combination_name
from aerocues.results.pair_classes import TURNED
from aerocues.scoring.combinations import SUCCESS
from aerocues.scoring.criteria import RIGHT_MATCHES
from aerocues.scoring.links import ENOUGH

if TYPE_CHECKING:
    import polars as pl

LEADERS, TURNING, FEWEST_DETECTORS = 3, 2, 3
FEWEST_TURNED = 2
"""Turned pairs that a combination must have been measured on: one may be a lucky one."""


def finalists(ranked: Sequence[str], rows: pl.DataFrame) -> list[Combination]:
    """Combinations that build models, the leader first.

    A final repairs a wrong order of the race only if what turns with the image is in it: so the
    best two on turned pairs build models, too, and three detectors at least.

    Parameters
    ----------
    ranked : sequence of str
        Combinations in the order of the race, the best first.
    rows : pl.DataFrame
        Rows that were measured.

    Returns
    -------
    list of Combination
        Each detector and descriptor once.
    """
    chosen: dict[tuple[str, str], Combination] = {}

    def take(names: Sequence[str], most: int) -> None:
        for name in names:
            combination = Combination.parse(name)
            if most <= 0:
                return
            if _features(combination) not in chosen:
                chosen[_features(combination)] = combination
                most -= 1

    take(ranked, LEADERS)
    take([name for name in _best_on_turned(rows) if name in set(ranked)], TURNING)
    for name in ranked:
        detectors = {detector for detector, _ in chosen}
        if len(detectors) >= FEWEST_DETECTORS:
            break
        if Combination.parse(name).detector not in detectors:
            take([name], 1)
    return list(chosen.values())


def _features(combination: Combination) -> tuple[str, str]:
    return combination.detector, combination.descriptor


def _best_on_turned(rows: pl.DataFrame) -> list[str]:
    """Combinations by their mean link over turned pairs, then by their right matches there."""
    import polars as pl

    if "reference_turn" not in rows.columns:
        return []
    right = pl.when(pl.col("status").is_in(SUCCESS)).then(pl.col(RIGHT_MATCHES)).fill_null(0.0)
    turned = (
        rows.filter(pl.col("reference_turn") > TURNED)
        .with_columns(combination_name(), right.alias("right"))
        .group_by(COMBINATION)
        .agg(
            (pl.col("right") / ENOUGH).clip(0.0, 1.0).mean().alias("link"),
            pl.col("right").mean(),
            pl.len().alias("pairs"),
        )
        .filter(pl.col("pairs") >= FEWEST_TURNED, pl.col("link") > 0)
        .sort(["link", "right", COMBINATION], descending=[True, True, False])
    )
    return [str(name) for name in turned[COMBINATION]]
