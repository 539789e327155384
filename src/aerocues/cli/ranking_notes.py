"""Notes below a ranking."""

from __future__ import annotations

from typing import TYPE_CHECKING

from aerocues.phrases import count

if TYPE_CHECKING:
    from aerocues.scoring.measured import MeasuredTable
    from aerocues.scoring.ranking import Ranking

NAMED = 8


def notes(ranking: Ranking) -> list[str]:
    """Lines about the figures and their uncertainty."""
    table = ranking.scores.table
    lines = [_how_counted(ranking)]
    if any(criterion.beyond_chance for criterion in table.criteria):
        lines.append("* minus the inliers of the same matches, shuffled.")
    lines += _significance(ranking)
    fewer = int((table.tried[ranking.scores.order] < len(table.repeats)).sum())
    if fewer:
        lines.append(
            f"{count(fewer, 'combination')} measured on fewer pairs: scored on these only."
        )
    unscored = ranking.unscored()
    if unscored:
        lines.append(
            f"without a score, for lack of a criterion: {len(unscored)} ({_some(unscored, 3)})"
        )
    return lines


def mixed_machines(measured: MeasuredTable) -> list[str]:
    """A warning if a ranking mixes times of several kinds of machine."""
    if len(measured.machines) < 2:
        return []
    return [
        f"This ranking mixes times of {len(measured.machines)} kinds of machine "
        f"({'; '.join(measured.machines)}), so speed is not comparable. Measure each kind into a "
        "separate folder (--resource)."
    ]


def _some(names: list[str], number: int) -> str:
    more = f" and {len(names) - number} more" if len(names) > number else ""
    return f"{', '.join(names[:number])}{more}"


def _how_counted(ranking: Ranking) -> str:
    settings = ranking.settings()
    failed = (
        "A failed pair counts as the worst"
        if settings["failures"] == "worst"
        else "Failed pairs are left out"
    )
    return (
        f"{failed}; criteria are means over the successful pairs, seconds the median over all. "
        f"{_drawn(ranking)}"
    )


def _drawn(ranking: Ranking) -> str:
    if ranking.resampled.units < 2:
        return "With a single pair the uncertainty of the scores is unknown."
    table = ranking.scores.table
    blocks = len(set(table.blocks.tolist()))
    resamples = f"Intervals from {len(ranking.resampled.scores):,} resamples of"
    if ranking.resampled.unit == "block":
        return f"{resamples} the {blocks} sequences."
    if 1 < blocks < len(table.repeats):
        return (
            f"{resamples} pairs. Pairs of one sequence are similar: with only {blocks} sequences "
            "the intervals are too narrow."
        )
    return f"{resamples} pairs."


def _significance(ranking: Ranking) -> list[str]:
    best = ranking.scores.table.alternatives[ranking.scores.best]
    against = ranking.against
    alike, untested = ranking.indistinguishable(), ranking.untested()
    lines = []
    if against != best:
        lines += _around(ranking)
    if alike:
        lines.append(
            f"not significantly different from {against} on these pairs: {_some(alike, NAMED)}"
        )
    if untested:
        lines.append(f"too few pairs for a test against {against}: {_some(untested, NAMED)}")
    others = len(ranking.scores.order) - 1
    if not others:
        lines.append("The score compares combinations: measure more than one.")
    if against == best and others and not alike and not untested:
        lines.append(f"{best} is significantly better than all others (corrected p < 0.05)")
    if not ranking.scores.table.by_repeat.all():
        lines.append(
            "Each combination was reconstructed once; the intervals exclude that variation."
        )
    return lines


def _around(ranking: Ranking) -> list[str]:
    """What is significantly better and worse than a chosen combination."""
    sides = (("better", ranking.surpassing()), ("worse", ranking.surpassed()))
    return [
        f"significantly {side} than {ranking.against} (corrected p < 0.05): {_some(names, NAMED)}"
        for side, names in sides
        if names
    ]
