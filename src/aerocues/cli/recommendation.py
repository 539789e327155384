"""A recommendation in words."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

from aerocues.cli.console import plain_table
from aerocues.phrases import count, likelihood, spoken_seconds

if TYPE_CHECKING:
    import polars as pl
    from rich.table import Table

    from aerocues.tuning.race import RaceOutcome
    from aerocues.tuning.recommendation import Recommendation

WIDTH = 100
PROBABLE = 0.5
# The named possible winners have this probability together.
TOGETHER = 0.9
MOST_NAMED = 8
GOOD = 0.9
"""Share of the best score at which a combination counts as good."""
FASTER = 2.0
ENDS = {
    "budget": "the budget was spent",
    "sure": "the probability is high enough",
    "measured": "all possible winners are measured on all pairs",
}


def answer(found: Recommendation) -> str:
    """The best combination, its probability, the reasons and the cost."""
    best = found.ranked.row(0, named=True)
    parts = [
        f"Take {found.best}.",
        "",
        _paragraph(_certainty(found, best)),
        "",
        *_labelled("why", _why(found, best)),
        *_labelled("costs", _costs(found, best)),
        *_labelled("faster", _faster(found, best)),
        *_labelled("note", _notes(found)),
    ]
    return "\n".join(parts)


def _paragraph(text: str) -> str:
    return textwrap.fill(text, WIDTH, break_on_hyphens=False, break_long_words=False)


def _labelled(label: str, sentences: list[str]) -> list[str]:
    """Sentences on lines of their own, with a label before the first."""
    lines = []
    for number, sentence in enumerate(sentences):
        begin = f"{label if not number else '':9}"
        lines.append(
            textwrap.fill(
                sentence,
                WIDTH,
                initial_indent=begin,
                subsequent_indent=" " * 9,
                break_on_hyphens=False,
                break_long_words=False,
            )
        )
    return lines


def _certainty(found: Recommendation, best: dict[str, Any]) -> str:
    outcome, chance = found.outcome, best["probability"]
    measured = int(outcome.known.sum())
    spent = spoken_seconds(outcome.rounds[-1].spent)
    basis = (
        f"{count(measured, 'measurement')} of {count(found.measured, 'combination')} on "
        f"{count(len(found.seen.overlapping), 'pair')} in {spent} ({ENDS[outcome.ended]})"
    )
    told = f"of {found.combinations} for {found.objective.title} on these pairs"
    if chance >= PROBABLE:
        first = f"It is the best {told} with a probability of {likelihood(chance)}"
    else:
        first = (
            f"It has the highest expected score {told}, but the probability that it is the best is "
            f"only {likelihood(chance)}"
        )
    names = possible_winners(found.ranked)
    others = [name for name in names if name != found.best]
    if not others:
        return f"{first}: {basis}."
    named = ", ".join(others[:MOST_NAMED])
    more = f" and {len(others) - MOST_NAMED} more" if len(others) > MOST_NAMED else ""
    return f"{first}: {basis}. {named}{more} could equally be the best."


def possible_winners(ranked: pl.DataFrame) -> list[str]:
    """The fewest combinations that include the best with a probability of 90 %."""
    likely = ranked.sort("probability", "score", descending=True)
    reached = likely["probability"].cum_sum().to_list()
    number = sum(total < TOGETHER for total in reached) + 1
    kept = likely.head(number)
    return list(kept.filter(kept["probability"] > 0)["combination"])


def _why(found: Recommendation, best: dict[str, Any]) -> list[str]:
    ranked = found.ranked
    others = len(ranked)

    def median(name: str) -> float:
        value = ranked[name].median()
        return float(value) if isinstance(value, int | float) else float("nan")

    beyond = "precision_beyond_chance" if best["excess_inliers"] is not None else "precision"
    inliers = "excess_inliers" if best["excess_inliers"] is not None else "inliers"
    what = " beyond chance" if inliers == "excess_inliers" else ""
    number, ratio = f"{best[inliers]:,.0f} inliers{what} per pair", f"{best[beyond]:.3f}"
    if others == 1:
        number += "; no other combination succeeded"
    else:
        number += f"; the median of the {others} successful combinations is "
        number += f"{median(inliers):,.0f}"
        ratio += f" ({median(beyond):.3f})"
    return [
        number,
        f"inlier ratio{what} {ratio}",
        f"{best['succeeded']} of {count(best['pairs'], 'pair')} succeeded",
    ]


def _costs(found: Recommendation, best: dict[str, Any]) -> list[str]:
    image = best["detect_seconds"] + best["describe_seconds"]
    return [
        f"{image:.2f} s per image (detect {best['detect_seconds']:.2f}, describe "
        f"{best['describe_seconds']:.2f}), and per pair {best['match_seconds']:.2f} s to match and "
        f"{best['verify_seconds']:.3f} s to verify, on one core of {found.machine}",
    ]


def _faster(found: Recommendation, best: dict[str, Any]) -> list[str]:
    """The fastest combination that is almost as good, if it is much faster."""
    good = found.ranked.filter(found.ranked["score"] >= GOOD * best["score"])
    fastest = good.sort("total_seconds", "combination").row(0, named=True)
    if fastest["total_seconds"] * FASTER > best["total_seconds"]:
        return []
    share = fastest["score"] / best["score"]
    times = best["total_seconds"] / fastest["total_seconds"]
    return [
        f"{fastest['combination']} has {share:.0%} of its score and takes "
        f"{fastest['total_seconds']:.2f} s in place of {best['total_seconds']:.2f} s: {times:.0f} "
        "times faster"
    ]


def _notes(found: Recommendation) -> list[str]:
    notes = []
    if found.seen.others:
        notes.append(
            f"{count(len(found.seen.others), 'pair')} left out: no model beats chance there, the "
            "images may not overlap"
        )
    stood = len(found.seen.overlapping) + len(found.seen.others)
    if stood < found.candidates:
        why = "; a larger --budget tests more" if found.seen.unseen else ""
        notes.append(f"{count(stood, 'pair')}, evenly spread, of {found.candidates} were used{why}")
    if len(found.seen.overlapping) < 5:
        more = "" if found.seen.unseen else "; give more images that overlap"
        notes.append(f"fewer than 5 pairs say little about other pairs{more}")
    return notes


def ranking(found: Recommendation, top: int) -> Table:
    """The best combinations by expected score."""
    headings = ("score", "best with", "pairs ok", "inlier ratio*", "inliers*", "seconds a pair")
    table = plain_table("rank", "combination", *headings, numbers=len(headings))
    chance_tested = found.ranked["excess_inliers"].is_not_null().any()
    ratio, inliers = (
        ("precision_beyond_chance", "excess_inliers") if chance_tested else ("precision", "inliers")
    )
    for rank, row in enumerate(found.ranked.head(top).iter_rows(named=True), start=1):
        table.add_row(
            f"{rank}",
            row["combination"],
            f"{row['score']:.3f}",
            likelihood(row["probability"]),
            f"{row['succeeded']}/{row['pairs']}",
            f"{row[ratio]:.3f}",
            f"{row[inliers]:,.0f}",
            f"{row['total_seconds']:.2f}",
        )
    return table


def story(outcome: RaceOutcome) -> Table:
    """The race, one line per round."""
    headings = ("seconds", "measured", "in the race", "chance")
    table = plain_table("leader", *headings, numbers=len(headings))
    for each in outcome.rounds:
        table.add_row(
            each.leader,
            f"{each.spent:.0f}",
            f"{each.measured:,}",
            f"{each.contenders}",
            likelihood(each.probability),
        )
    return table
