"""How well a race finds the best of a full evaluation, and what it costs.

    python benchmarks/racing.py [RESULTS...] [--seeds 20] [--sure 1]

Races on the published measurements, which stand beside the project, or on results folders that
hold every combination on every pair. Prints a row a data set: the share of the CPU time that was
used, the regret in CUES of the choice, how many of the best five were among the race's five, the
probability that the race gave its choice and how often that was the best; beside it uniform
sampling of as many pairs as the same time buys.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path

import numpy as np
import polars as pl
from numpy.typing import NDArray
from racing_on_flights import seconds_of
from replay import ReplayEvaluator

from aerocues.results.combination_columns import combination_name
from aerocues.results.measured_results import Results
from aerocues.scoring.criteria import CRITERIA, Criterion
from aerocues.scoring.cues import score
from aerocues.scoring.measured import table_of
from aerocues.scoring.settings import ScoreSettings
from aerocues.scoring.table import DecisionTable
from aerocues.tuning.race import FEW, RaceSettings, race

NAMES = (
    "recall", "precision", "repeatability", "f1_score", "inliers", "matches",
    "seconds_per_1k_matches", "seconds_per_1k_inliers",
)  # fmt: skip
BITS = ("akaze", "orb", "brisk", "freak", "brief", "lucid", "latch", "beblid", "teblid", "boost")
DATASETS = ("synthetic", "oxford", "airsim", "drone")
SHARE = 0.05
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
    ).with_columns(name=combination_name())
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


def measured(folder: str) -> tuple[list[str], Values, Values, NDArray[np.int64], list[Criterion]]:
    """The same of a results folder, and its criteria; brute force costs what exact search does."""
    results = Results(folder)
    table = table_of(results).table
    rows = results.table().with_columns(name=combination_name())
    alternatives = list(table.alternatives)
    position = {name: i for i, name in enumerate(alternatives)}
    place = {name: i for i, name in enumerate(table.repeats)}
    seconds = np.zeros(table.values.shape[:2])
    for name, pair, value in rows.select("name", "pair", seconds_of(rows)).iter_rows():
        if str(pair) in place:  # others have no reference
            seconds[position[name], place[str(pair)]] = value
    return alternatives, table.values, seconds, table.blocks, list(table.criteria)


def judge(source: str, seeds: int, sure: float) -> str:
    by_name = {criterion.name: criterion for criterion in CRITERIA}
    if source in DATASETS:
        alternatives, values, seconds, blocks = published(source)
        criteria = [by_name[name] for name in NAMES]
    else:
        alternatives, values, seconds, blocks, criteria = measured(source)
    components = {
        what: [name.split("-")[place] for name in alternatives]
        for what, place in (("detector", 0), ("descriptor", 1), ("matcher", 3))
    }

    def cues(chosen: Values) -> Values:
        return score(DecisionTable.from_values(chosen, alternatives, criteria)).scores

    full = cues(values)
    best = np.argsort(-full)
    shares, regrets, found, chances, uniform_regrets, uniform_found = [], [], [], [], [], []
    for seed in range(seeds):
        rng = np.random.default_rng(1000 + seed)
        # Costs are known before only roughly: within a third.
        predicted = seconds.mean(axis=1) * np.exp(rng.normal(0, 0.3, len(alternatives)))
        evaluator = ReplayEvaluator(
            alternatives, components, criteria, values, blocks, seconds, predicted
        )
        settings = RaceSettings(SHARE * evaluator.total, seed, sure=sure, score=ScoreSettings())
        outcome = race(evaluator, settings)
        shares.append(evaluator.spent / evaluator.total)
        regrets.append(full[best[0]] - full[outcome.order[0]])
        found.append(len(set(outcome.order[:FEW]) & set(best[:FEW])))
        chances.append(outcome.probability[outcome.order[0]])
        sample = rng.permutation(len(blocks))[: max(round(SHARE * len(blocks)), 1)]
        scores = np.nan_to_num(cues(values[:, sample]), nan=-1.0)
        order = np.argsort(-scores)
        uniform_regrets.append(full[best[0]] - full[order[0]])
        uniform_found.append(len(set(order[:FEW]) & set(best[:FEW])))
    hits = np.mean(np.array(regrets) == 0)
    return (
        f"{Path(source).name:12s} {len(blocks):5d} {np.mean(shares):6.1%}   "
        f"{np.median(regrets):.4f} {max(regrets):.4f} {np.mean(found):.2f} "
        f"{np.mean(chances):6.0%} {hits:5.0%}    "
        f"{np.median(uniform_regrets):.4f} {max(uniform_regrets):.4f} {np.mean(uniform_found):.2f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("results", nargs="*", default=DATASETS, help="folders, or published sets")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--sure", type=float, default=1.0, help="1: until the budget is spent")
    arguments = parser.parse_args()
    print("                            race                                 uniform, whole pairs")
    print("dataset      pairs    CPU   regret  worst of 5 chance  best    regret  worst  of 5")
    for source in arguments.results:
        print(judge(source, arguments.seeds, arguments.sure), flush=True)


if __name__ == "__main__":
    main()
