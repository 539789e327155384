"""How far from the best the leader of a race is, on flights that were measured whole.

    python benchmarks/racing_on_flights.py RESULTS... [--seeds 20] [--objective NAME]

RESULTS are folders that hold many combinations on the same pairs with a reference, such as the
parts of `study/database`. Races as those of `aerocues recommend` are run again on their rows, with
4 and 8 % of the CPU time of all. Prints, a row each, the regret of the leader (1 - its score over
that of the best) as mean and worst of all seeds, and the mean regret of the best of the first five.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import polars as pl
from numpy.typing import NDArray
from replay import ReplayEvaluator

from aerocues.pipeline.reference import FLOW
from aerocues.results.combination_columns import combination_name
from aerocues.results.measured_results import Results
from aerocues.results.pair_classes import pair_class
from aerocues.scoring.criteria import Criterion, criteria_named
from aerocues.scoring.objectives import OBJECTIVES
from aerocues.scoring.valuation import Valuation
from aerocues.tuning.costs import EXACT_SECONDS, EXACT_SHARE
from aerocues.tuning.image_evaluator import criterion_values
from aerocues.tuning.race import FEW, RaceSettings, race
from aerocues.tuning.scales import Scales

SHARES = (0.04, 0.08)
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Flight:
    """Values (A, P, C) and seconds (A, P) of the combinations that were measured on all pairs."""

    names: list[str]
    values: Array
    seconds: Array
    classes: NDArray[np.int64]
    settings: RaceSettings
    """Without budget and seed."""

    def scores(self) -> Array:
        """(A,) of the whole measurement."""
        criteria, settings = self.criteria, self.settings
        cost = np.array([criterion.better == "lower" for criterion in criteria])
        scales = Scales.of(self.values.reshape(-1, len(cost)), cost)
        whole = scales.shrink(scales.stretch(self.values))
        blocks = np.zeros(len(self.classes), np.int64)
        valued = Valuation(
            *(whole, criteria, blocks, settings.score, settings.objective), classes=self.classes
        )
        return valued.of(whole)

    @property
    def criteria(self) -> list[Criterion]:
        """Of the objective."""
        objective = self.settings.objective
        return criteria_named(objective.criteria(objective.scoring(references=True)))

    def evaluator(self, predicted: Array) -> ReplayEvaluator:
        """Gives the values, for what they would have cost."""
        parts = [name.split("-") for name in self.names]
        components = {
            what: [part[place] for part in parts]
            for what, place in (("detector", 0), ("descriptor", 1), ("matcher", 3))
        }
        blocks = np.zeros(len(self.classes), np.int64)
        evaluator = ReplayEvaluator(
            *(self.names, components, self.criteria, self.values, blocks, self.seconds, predicted)
        )
        evaluator.classes = self.classes
        return evaluator


def seconds_of(rows: pl.DataFrame) -> pl.Series:
    """CPU seconds to measure each row in a race; brute force costs what exact search does."""
    images = (f"{stage}_seconds_{side}_cpu" for stage in ("detect", "describe") for side in (1, 2))
    match = pl.col("match_seconds_cpu").fill_null(0.0)
    share = pl.col("norm").replace_strict(EXACT_SHARE, return_dtype=pl.Float64)
    exact = pl.min_horizontal(match, EXACT_SECONDS + share * match)
    cost = (
        pl.sum_horizontal(pl.col(*images).fill_null(0.0))
        + pl.when(pl.col("matcher") == "BF").then(exact).otherwise(match)
        + 6 * pl.col("verify_seconds_cpu").fill_null(0.0)
    )
    return rows.select(seconds=cost).to_series()


def flight_of(folder: Path, objective: str) -> Flight:
    """What was measured on all pairs with a reference, without what failed on all of them."""
    rows = Results(folder).table().filter(pl.col("reference") == FLOW)
    rows = rows.with_columns(name=combination_name()).unique(["name", "pair"], maintain_order=True)
    pairs = rows["pair"].unique().sort().to_list()
    counts = rows.filter(pl.col("status") == "ok").join(
        rows.group_by("name").len().filter(pl.col("len") == len(pairs)), on="name", how="semi"
    )
    names = counts["name"].unique().sort().to_list()
    rows = rows.filter(pl.col("name").is_in(names)).sort("name", "pair")
    aim = OBJECTIVES[objective]
    scoring = aim.scoring(references=True)
    criteria = criteria_named(aim.criteria(scoring))
    shape = (len(names), len(pairs))
    turns = rows.head(len(pairs))["reference_turn"].fill_null(0.0)
    return Flight(
        names,
        criterion_values(rows.drop("name").to_dicts(), criteria).reshape(*shape, -1),
        seconds_of(rows).to_numpy().reshape(shape),
        np.array([pair_class(turn) == "turned" for turn in turns], np.int64),
        RaceSettings(0.0, score=scoring.settings, objective=aim),
    )


def regrets(flight: Flight, share: float, seed: int) -> tuple[float, float]:
    """Of the leader, and of the best of the first five."""
    truth = flight.scores()
    random = np.random.default_rng(1000 + seed)
    # Costs are known before only roughly: within a third.
    predicted = flight.seconds.mean(axis=1) * np.exp(random.normal(0, 0.3, len(flight.names)))
    evaluator = flight.evaluator(predicted)
    budget = share * evaluator.total
    order = race(evaluator, replace(flight.settings, budget=budget, seed=seed)).order
    found = 1 - truth[order] / truth.max()
    return float(found[0]), float(found[:FEW].min())


def main() -> None:
    """Race and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("results", nargs="+", type=Path)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--objective", default="balanced", choices=OBJECTIVES)
    asked = parser.parse_args()
    for folder in asked.results:
        flight = flight_of(folder, asked.objective)
        pairs = f"{len(flight.classes)} pairs, {flight.classes.sum()} turned"
        print(f"{folder.name}, {asked.objective}: {len(flight.names)} combinations on {pairs}")
        for share in SHARES:
            found = np.array([regrets(flight, share, seed) for seed in range(asked.seeds)])
            first, five = found.T
            print(
                f"  {share:.0%} of the time: mean {first.mean():.3f}, worst {first.max():.3f}, "
                f"best of five {five.mean():.3f}, {np.mean(first == 0):.0%} the best",
                flush=True,
            )


if __name__ == "__main__":
    main()
