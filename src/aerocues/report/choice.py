"""Chooses the combinations and pairs for the pictures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aerocues.report.entry import ReportEntry
from aerocues.report.scores import best_binary, fastest_good
from aerocues.results.combination_columns import combination_name
from aerocues.scoring.per_repeat import scores_of_repeats

DETECTOR = 0


@dataclass(frozen=True)
class Choice:
    """A combination on a pair, and why each is shown."""

    combination: str
    pair: int
    why: str
    role: str


def chosen_combinations(found: ReportEntry, number: int) -> dict[str, str]:
    """The best, the best with another detector, the best binary, the fastest good one, others.

    Returns
    -------
    dict of str to str
        Reason for each, the most important first.
    """
    ranking = found.ranking
    names, order = found.combinations, ranking.scores.order.tolist()
    best = order[0]
    detector = names[best].split("-")[DETECTOR]
    other = next((each for each in order if names[each].split("-")[DETECTOR] != detector), None)
    reasons = [
        (best, "best"),
        (other, "best with another detector"),
        (best_binary(ranking), "best binary"),
        (fastest_good(ranking, found.seconds()), "fastest good one"),
        *((each, "among the best") for each in order),
    ]
    chosen: dict[str, str] = {}
    for position, why in reasons:
        if position is not None and len(chosen) < number:
            chosen.setdefault(names[position], why)
    return chosen


def chosen_pictures(found: ReportEntry, number: int) -> list[Choice]:
    """The pictures to draw, the most important first.

    All combinations share the best, median and worst pair of the best combination, so that they can
    be compared side by side. Each combination also gets its own worst pair.
    """
    combinations = chosen_combinations(found, number)
    if not combinations:
        return []
    by_name = {name: _pairs_by_score(found, name) for name in combinations}
    along = by_name[next(iter(combinations))]
    shared = {
        along[len(along) // 2]: "median pair",
        along[0]: "worst pair",
        along[-1]: "best pair",
    }
    choices = [
        Choice(name, pair, why, combinations[name])
        for pair, why in shared.items()
        for name in combinations
        if pair in by_name[name]
    ]
    choices += [
        Choice(name, pairs[0], f"worst pair of {name}", combinations[name])
        for name, pairs in by_name.items()
        if pairs and pairs[0] not in shared
    ]
    return choices


def _pairs_by_score(found: ReportEntry, combination: str) -> list[int]:
    """Numbers of the pairs of a combination, the worst first."""
    position = found.combinations.index(combination)
    table = found.ranking.scores.table
    values = scores_of_repeats(found.ranking.scores)[position]
    # A failed pair is the worst, even if the score ignores it.
    score = dict(zip(map(int, table.repeats), np.nan_to_num(values, nan=-1.0), strict=True))
    name = combination_name()
    measured = found.rows.filter(name == combination)["pair"].to_list()
    return sorted(measured, key=lambda pair: (score[pair], -pair))
