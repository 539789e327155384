"""Which combinations and which pairs are worth a picture."""

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
    """A combination on a pair, and why each of them is shown."""

    combination: str
    pair: int
    why: str
    role: str


def chosen_combinations(found: ReportEntry, number: int) -> dict[str, str]:
    """The best, one with another detector, the best binary, the fastest good one, then others.

    Returns
    -------
    dict of str to str
        Why each is shown, the most important first.
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

    The same pairs for all combinations, so that these can be set side by side: the best, median
    and worst pair of the best combination; and each one's own worst pair.
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
    """Numbers of the pairs that a combination was measured on, the worst first."""
    position = found.combinations.index(combination)
    table = found.ranking.scores.table
    values = scores_of_repeats(found.ranking.scores)[position]
    # A failed pair that is left out of the score is the worst all the same.
    score = dict(zip(map(int, table.repeats), np.nan_to_num(values, nan=-1.0), strict=True))
    name = combination_name()
    measured = found.rows.filter(name == combination)["pair"].to_list()
    return sorted(measured, key=lambda pair: (score[pair], -pair))
