"""A ranking in the payload: one value per combination, in the order of the table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.report.columns import criterion_facts
from aerocues.results.combination_columns import METHODS
from aerocues.scoring.ranking import Ranking

FIGURES = (
    "rank",
    "rank_low",
    "rank_high",
    "score",
    "score_low",
    "score_high",
    "probability_best",
    "probability_top",
    "p_value",
    "success_rate",
    "repeats",
)
NORM = METHODS.index("norm")
BINARY_NORM = "HAM"
# A combination is good if it reaches this share of the best score.
GOOD = 0.9


def score_facts(ranking: Ranking, seconds: Mapping[str, float], preset: str) -> dict[str, Any]:
    """The scores of all combinations, and the best ones by several criteria.

    Parameters
    ----------
    ranking : Ranking
    seconds : mapping of str to float
        Median time of each combination, where known.
    preset : str
        Scoring preset.
    """
    scores = ranking.scores
    table = scores.table
    rows = {row["combination"]: row for row in ranking.frame("combination").to_dicts()}
    by_figure = {
        name: [rows.get(each, {}).get(name) for each in table.alternatives] for name in FIGURES
    }
    # These are known for combinations without a score, too.
    by_figure["success_rate"] = table.success_rate.tolist()
    by_figure["repeats"] = table.tried.tolist()
    names = table.criterion_names
    weights = ranking.weights()
    return {
        "criteria": criterion_facts(table.criteria),
        **by_figure,
        "means": dict(zip(names, scores.means.T, strict=True)),
        "normalised": dict(zip(names, scores.normalised.T, strict=True)),
        "weights": {
            "methods": weights.columns[1:],
            "values": {method: weights[method].to_list() for method in weights.columns[1:]},
        },
        "settings": {"preset": preset, **ranking.settings(), "good": GOOD},
        "best": scores.best,
        "indistinguishable": _in_order(ranking, ranking.comparisons.indistinguishable()),
        "untested": _in_order(ranking, ranking.comparisons.untested()),
        "units": ranking.resampled.units,
        "fastest_good": fastest_good(ranking, seconds),
        "best_binary": best_binary(ranking),
    }


def _in_order(ranking: Ranking, positions: NDArray[np.int64]) -> list[int]:
    """These positions, the best first."""
    kept = set(positions.tolist())
    return [int(position) for position in ranking.scores.order if int(position) in kept]


def fastest_good(ranking: Ranking, seconds: Mapping[str, float]) -> int | None:
    """The fastest with at least `GOOD` of the best score and of its success rate; None if unknown.

    Parameters
    ----------
    ranking : Ranking
    seconds : mapping of str to float
        Median time of each combination, where known.
    """
    scores, success = ranking.scores, ranking.scores.table.success_rate
    names = scores.table.alternatives
    good = [
        int(position)
        for position in scores.order
        if scores.scores[position] >= GOOD * scores.scores[scores.best]
        and success[position] >= GOOD * success[scores.best]
        and names[position] in seconds
    ]
    return min(good, key=lambda position: seconds[names[position]], default=None)


def best_binary(ranking: Ranking) -> int | None:
    """The best combination with binary descriptors; None if there are none."""
    names = ranking.scores.table.alternatives
    binary = (
        int(position)
        for position in ranking.scores.order
        if names[position].split("-")[NORM] == BINARY_NORM
    )
    return next(binary, None)


def method_labels(combinations: tuple[str, ...]) -> dict[str, list[str]]:
    """Detector, descriptor, norm and matcher of each combination."""
    parts = np.array([name.split("-") for name in combinations])
    return {method: parts[:, column].tolist() for column, method in enumerate(METHODS)}


def cautions(ranking: Ranking) -> list[str]:
    """Limits of the intervals."""
    table, resampled = ranking.scores.table, ranking.resampled
    blocks = len(set(table.blocks.tolist()))
    told = []
    if resampled.units < 2:
        told.append("with a single pair the uncertainty of the scores is unknown")
    elif resampled.unit != "block" and 1 < blocks < len(table.repeats):
        told.append(
            f"pairs of one sequence are similar; with only {blocks} sequences the intervals "
            "are too narrow"
        )
    if not table.by_repeat.all():
        told.append("each combination was reconstructed once; the intervals exclude that variation")
    return told
