"""How well a race finds the best of a full evaluation, and what it costs, on published figures.

Prints a row a data set: the share of the CPU time that was used, the regret in CUES of the choice,
and how many of the best five were among the race's five; beside it uniform sampling of as many
pairs as the same time buys. Needs the published measurements beside the project.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np
import polars as pl
from numpy.typing import NDArray

from aerocues.scoring.criteria import CRITERIA
from aerocues.scoring.cues import score
from aerocues.scoring.settings import ScoreSettings
from aerocues.scoring.table import DecisionTable
from aerocues.tuning.race import FEW, RaceSettings, race
from aerocues.tuning.replay import ReplayArena

NAMES = (
    "recall", "precision", "repeatability", "f1_score", "inliers", "matches",
    "seconds_per_1k_matches", "seconds_per_1k_inliers",
)  # fmt: skip
BITS = ("akaze", "orb", "brisk", "freak", "brief", "lucid", "latch", "beblid", "teblid", "boost")
DATASETS = ("synthetic", "oxford", "airsim", "drone")
SHARE = 0.05
SEEDS = 20
Values = NDArray[np.float64]


def published(dataset: str) -> tuple[list[str], Values, Values, NDArray[np.int64]]:
    """Meaningful alternatives, their values (A, P, C), seconds (A, P) and the blocks of pairs."""
    root = Path(os.environ.get("AEROCUES_SHARED_DATA", "../shared/data"))
    table = pl.read_parquet(root / "published" / "measurements.parquet").with_columns(
        pl.col(pl.Categorical).cast(pl.String)
    )
    table = table.filter(
        (pl.col("dataset") == dataset)
        & (pl.col("platform") == "desktop")
        & ~((pl.col("norm") == "l2") & pl.col("descriptor").is_in(BITS))
    ).with_columns(name=pl.concat_str(["detector", "descriptor", "norm", "matcher"], separator="-"))
    alternatives = table["name"].unique(maintain_order=True).to_list()
    position = {name: i for i, name in enumerate(alternatives)}
    rows = np.array([position[name] for name in table["name"]])
    pairs = table["pair"].to_numpy().astype(int)
    values = np.full((len(alternatives), pairs.max() + 1, len(NAMES)), np.nan)
    values[rows, pairs] = table.select(NAMES).to_numpy()
    values[~np.isfinite(values).all(axis=2)] = np.nan
    seconds = values[..., 6] * values[..., 5] / 1000
    mean = np.nanmean(seconds, axis=1, keepdims=True)
    seconds = np.where(np.isnan(seconds), mean, seconds)
    count = values.shape[1]
    blocks = np.zeros(count, np.int64)
    if dataset == "oxford":
        blocks = np.arange(count) // 5
    if dataset == "synthetic":
        blocks = np.repeat([0, 1, 2, 3], [6, 6, 4, 4])
    return alternatives, values, seconds, blocks


def judge(dataset: str, seeds: int) -> str:
    alternatives, values, seconds, blocks = published(dataset)
    by_name = {criterion.name: criterion for criterion in CRITERIA}
    criteria = [by_name[name] for name in NAMES]
    components = {
        what: [name.split("-")[place] for name in alternatives]
        for what, place in (("detector", 0), ("descriptor", 1), ("matcher", 3))
    }

    def cues(chosen: Values) -> Values:
        return score(DecisionTable.from_values(chosen, alternatives, criteria)).scores

    full = cues(values)
    best = np.argsort(-full)
    shares, regrets, found, uniform_regrets, uniform_found = [], [], [], [], []
    for seed in range(seeds):
        rng = np.random.default_rng(1000 + seed)
        # Costs are known before only roughly: within a third.
        predicted = seconds.mean(axis=1) * np.exp(rng.normal(0, 0.3, len(alternatives)))
        arena = ReplayArena(alternatives, components, criteria, values, blocks, seconds, predicted)
        settings = RaceSettings(SHARE * arena.total, seed, score=ScoreSettings())
        outcome = race(arena, settings)
        shares.append(arena.spent / arena.total)
        regrets.append(full[best[0]] - full[outcome.order[0]])
        found.append(len(set(outcome.order[:FEW]) & set(best[:FEW])))
        sample = rng.permutation(len(blocks))[: max(round(SHARE * len(blocks)), 1)]
        scores = np.nan_to_num(cues(values[:, sample]), nan=-1.0)
        order = np.argsort(-scores)
        uniform_regrets.append(full[best[0]] - full[order[0]])
        uniform_found.append(len(set(order[:FEW]) & set(best[:FEW])))
    return (
        f"{dataset:10s} {np.mean(shares):6.1%}   {np.median(regrets):.4f} {max(regrets):.4f} "
        f"{np.mean(found):.2f}    {np.median(uniform_regrets):.4f} {max(uniform_regrets):.4f} "
        f"{np.mean(uniform_found):.2f}"
    )


def main() -> None:
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else SEEDS
    print(f"{seeds} seeds         race                   uniform, whole pairs")
    print("dataset       CPU   regret  worst  of 5    regret  worst  of 5")
    for dataset in DATASETS:
        print(judge(dataset, seeds), flush=True)


if __name__ == "__main__":
    main()
