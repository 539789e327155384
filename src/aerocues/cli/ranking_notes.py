"""What must be said below a ranking."""

from __future__ import annotations

from typing import TYPE_CHECKING

from aerocues.phrases import count

if TYPE_CHECKING:
    from aerocues.scoring.measured import MeasuredTable
    from aerocues.scoring.ranking import Ranking

NAMED = 8


def notes(ranking: Ranking) -> list[str]:
    """Lines that say how the figures came about and how sure they are."""
    table = ranking.scores.table
    lines = [_how_counted(ranking)]
    if any(criterion.beyond_chance for criterion in table.criteria):
        lines.append("* beyond those that the same matches give when shuffled.")
    lines += _how_sure(ranking)
    fewer = int((table.tried[ranking.scores.order] < len(table.repeats)).sum())
    if fewer:
        lines.append(f"{count(fewer, 'combination')} on fewer pairs than all: scored on their own.")
    unscored = ranking.unscored()
    if unscored:
        lines.append(
            f"without a score, as they lack a criterion: {len(unscored)} ({_some(unscored, 3)})"
        )
    return lines


def mixed_machines(measured: MeasuredTable) -> list[str]:
    """A line where times of several kinds of machine went into one ranking."""
    if len(measured.machines) < 2:
        return []
    return [
        f"Times of {len(measured.machines)} kinds of machine are mixed here "
        f"({'; '.join(measured.machines)}): the part that speed has in the scores is not fair. "
        "Measure each kind into a folder of its own (--resource)."
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
        f"{failed}; criteria are means over the pairs that succeeded, seconds the median of all. "
        f"{_drawn(ranking)}"
    )


def _drawn(ranking: Ranking) -> str:
    if ranking.resampled.units < 2:
        return "One pair says nothing of how sure the scores are."
    table = ranking.scores.table
    blocks = len(set(table.blocks.tolist()))
    resamples = f"Intervals from {len(ranking.resampled.scores):,} resamples of"
    if ranking.resampled.unit == "block":
        return f"{resamples} the {blocks} sequences."
    if 1 < blocks < len(table.repeats):
        return (
            f"{resamples} pairs; those of one sequence are alike, so that with only {blocks} "
            "sequences the intervals are too narrow."
        )
    return f"{resamples} pairs."


def _how_sure(ranking: Ranking) -> list[str]:
    best = ranking.scores.table.alternatives[ranking.scores.best]
    alike, untested = ranking.indistinguishable(), ranking.untested()
    lines = []
    if alike:
        lines.append(f"cannot be told from {best} on these pairs: {_some(alike, NAMED)}")
    if untested:
        told = f"too few pairs to tell {best} from"
        lines.append(f"{told}: {_some(untested, NAMED)}")
    others = len(ranking.scores.order) - 1
    if not others:
        lines.append("A score compares: of a single combination it says nothing. Measure others.")
    if others and not alike and not untested:
        lines.append(f"{best} is better than every other one (corrected p < 0.05)")
    if not ranking.scores.table.by_repeat.all():
        lines.append("Of the reconstruction there is one figure each: its luck is in no interval.")
    return lines
