"""What is lost where only some pairs are timed alone: ranks against those with all pairs timed.

    aerocues run photos -o results --timing estimated
    aerocues run photos -o results --timing-pairs 0
    python benchmarks/sampled_timing.py results

For samples of each size, drawn with many seeds as a run draws them, the rows of the other pairs
lose their own times and are scaled. Prints Spearman's correlation of the scores and of the median
seconds a pair with those of the full timing (mean and least over the seeds), how often the best is
the same, and the median error of the seconds.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np
import polars as pl
from scipy.stats import spearmanr

import aerocues
from aerocues.datasets.dataset import Pair
from aerocues.evaluation.passes import passes
from aerocues.results.combination_columns import combination_name
from aerocues.results.measured_results import Results
from aerocues.results.store import Store

SIZES = (1, 2, 3, 5, 10)
SEEDS = 10


def scored(results: Results) -> pl.DataFrame:
    """Score and median seconds of each combination, by name."""
    scores = aerocues.score(results).frame("combination").select("combination", "score")
    seconds = (
        results.table()
        .group_by(combination_name())
        .agg(pl.median("total_seconds").alias("seconds"))
    )
    return scores.join(seconds, on="combination").sort("combination")


def sampled(store: Store, pairs: frozenset[int]) -> pl.DataFrame:
    """The same where only `pairs` were timed alone."""
    numbers = store.planned().select("row_key", pl.col("pair").alias("planned"))
    rows = store.rows().join(numbers, on="row_key")
    kept = rows.filter((pl.col("timing") != "exclusive") | pl.col("planned").is_in(pairs))
    with tempfile.TemporaryDirectory() as place:
        other = Store.create(Path(place) / "results")
        kept.drop("planned").write_parquet(other.folder / "parts" / "all.parquet")
        other.write_plan(store.plan())
        other.write_run(store.run())
        return scored(Results(other.folder))


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("results", type=Path)
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES)
    parser.add_argument("--seeds", type=int, default=SEEDS)
    arguments = parser.parse_args()
    store = Store.open(arguments.results)
    full = scored(Results(arguments.results))
    named = store.planned().select("pair", "image_1", "image_2", "sequence").unique("pair")
    pairs = [Pair(*row) for row in named.sort("pair").iter_rows()]
    best = full["combination"][int(full["score"].arg_max() or 0)]
    print(f"{len(full)} combinations on {len(pairs)} pairs")
    print("timed   scores (least)   seconds (least)   same best   error of seconds")
    for size in (size for size in arguments.sizes if size < len(pairs)):
        scores, seconds, same, errors = [], [], [], []
        for seed in range(arguments.seeds):
            chosen = passes(pairs, "exclusive", size, seed)[1].pairs or frozenset()
            found = sampled(store, chosen)
            scores.append(spearmanr(full["score"], found["score"]).statistic)
            known = (full["seconds"].is_not_null() & found["seconds"].is_not_null()).to_numpy()
            before, after = (each["seconds"].to_numpy()[known] for each in (full, found))
            seconds.append(spearmanr(before, after).statistic)
            same.append(found["combination"][int(found["score"].arg_max() or 0)] == best)
            errors.append(np.median(np.abs(after / before - 1)))
        print(
            f"{size:5d}   {np.mean(scores):.4f} ({min(scores):.4f})  {np.mean(seconds):.4f} "
            f"({min(seconds):.4f})   {np.mean(same):5.0%}       {np.mean(errors):6.1%}",
            flush=True,
        )


if __name__ == "__main__":
    main()
