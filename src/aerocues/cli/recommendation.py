"""A recommendation in words."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

from aerocues.cli.console import plain_table
from aerocues.cli.final_words import headline, notes
from aerocues.cli.next_commands import quickly_matched
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
STUDIED_WIDTHS = (1000, 4000)
STUDIED_AGREEMENT = "0.54"
STUDIED_PLACE = "4 of 20"
"""Where the best combination of the smaller width stands at the larger one (docs/study.md)."""
ENDS = {
    "budget": "the budget was spent",
    "sure": "the probability is high enough",
    "measured": "all possible winners are measured on all pairs",
}


def answer(found: Recommendation, shrunk: int = 0) -> str:
    """The best combination, its probability, the reasons and the cost.

    `shrunk` is the width to which wider images are shrunk, 0 for images as they are.
    """
    final, best = found.final, found.ranked.row(0, named=True)
    parts = [
        _paragraph(headline(final, found.leader) if final else f"Take {found.best}."),
        "",
        *(_labelled("models", notes(final)) if final else ()),
        *_labelled("race", [_certainty(found, best)]),
        *_labelled("why", _why(found, best)),
        *_labelled("costs", _costs(found, best)),
        *_labelled("faster", _faster(found, best)),
        *_labelled("note", [*_notes(found), *_width(shrunk)]),
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
        first = (
            f"{found.leader} is the best {told} with a probability of {found.likelihood(chance)}"
        )
    else:
        first = (
            f"{found.leader} has the highest expected score {told}, but the probability that it is "
            f"the best is only {found.likelihood(chance)}"
        )
    names = possible_winners(found.ranked)
    others = [name for name in names if name != found.leader]
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

    share, column, name = _quality(ranked)
    number, ratio = f"{best[column] or 0.0:,.0f} {name} a pair", f"{best[share] or 0.0:.3f}"
    if others == 1:
        number += "; no other combination succeeded"
    else:
        number += f"; the median of the {others} successful combinations is {median(column):,.0f}"
        ratio += f" (median {median(share):.3f})"
    return [
        number,
        f"share of the matches {ratio}",
        f"{best['succeeded']} of {count(best['pairs'], 'pair')} succeeded",
    ]


def _costs(found: Recommendation, best: dict[str, Any]) -> list[str]:
    image = best["detect_seconds"] + best["describe_seconds"]
    told = [
        f"{image:.2f} s per image (detect {best['detect_seconds']:.2f}, describe "
        f"{best['describe_seconds']:.2f}), and per pair {best['match_seconds']:.2f} s to match and "
        f"{best['verify_seconds']:.3f} s to verify, on one core of {found.machine}",
    ]
    if quickly_matched(found.leader) != found.leader:
        told.append("the matcher EXACT finds the matches of BF in a fraction of its time")
    return told


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
    seen = found.seen
    notes = list(found.flight.notes()) if found.flight else []
    if seen.others:
        notes.append(
            f"{count(len(seen.others), 'pair')} left out: no model beats chance there, the "
            "images may not overlap"
        )
    if seen.failed:
        notes.append(
            f"{count(len(seen.failed), 'pair')} left out, which cannot be measured: "
            f"{seen.failed[0][1]}"
        )
    lacking = len(seen.overlapping) - len(seen.referenced)
    if seen.referenced and lacking:
        notes.append(
            f"{count(lacking, 'pair')} left out: it is not known which matches are right there "
            "(heavy blur, wide steps or large changes)"
        )
    stood = len(seen.overlapping) + len(seen.others)
    if not found.flight and stood < found.candidates:
        why = "; a larger --budget tests more" if seen.unseen else ""
        notes.append(f"{count(stood, 'pair')}, evenly spread, of {found.candidates} were used{why}")
    if len(seen.overlapping) < 5:
        more = "" if seen.unseen else "; give more images that overlap"
        notes.append(f"fewer than 5 pairs say little about other pairs{more}")
    from aerocues.pipeline.equal_footing import told_short

    short = told_short(found.footings)
    return [*notes, short] if short else notes


def _width(shrunk: int) -> list[str]:
    small, large = STUDIED_WIDTHS
    if not 0 < shrunk < large:
        return []
    return [
        f"measured on images of {shrunk:,} px; if you reconstruct larger ones, the order may be "
        f"another: on a studied flight, scores at {small:,} and {large:,} px correlate to "
        f"{STUDIED_AGREEMENT}, and the best at {small:,} px has place {STUDIED_PLACE} at "
        f"{large:,} px; --max-width {large} measures there"
    ]


def quality_note(found: Recommendation) -> str:
    """What the figures of matches in the table mean."""
    return {
        "right matches": "right within 3 px of the reference, a dense flow between the two images",
        "inliers beyond chance": "minus the inliers of the same matches, shuffled",
        "inliers": "matches that agree with the model",
    }[_quality(found.ranked)[2]]


def _quality(ranked: pl.DataFrame) -> tuple[str, str, str]:
    """The columns of the share and the number of good matches, and what those are called."""
    for share, number, name in (
        ("ref_precision@3", "ref_matches@3", "right matches"),
        ("precision_beyond_chance", "excess_inliers", "inliers beyond chance"),
    ):
        if number in ranked.columns and ranked[number].is_not_null().any():
            return share, number, name
    return "precision", "inliers", "inliers"


def ranking(found: Recommendation, top: int) -> Table:
    """The best combinations by expected score."""
    share, number, name = _quality(found.ranked)
    headings = ("score", "best with", "pairs ok", "share*", f"{name}*", "seconds a pair")
    table = plain_table("rank", "combination", *headings, numbers=len(headings))
    for rank, row in enumerate(found.ranked.head(top).iter_rows(named=True), start=1):
        table.add_row(
            f"{rank}",
            row["combination"],
            f"{row['score']:.3f}",
            found.likelihood(row["probability"]),
            f"{row['succeeded']}/{row['pairs']}",
            f"{row[share] or 0.0:.3f}",
            f"{row[number] or 0.0:,.0f}",
            f"{row['total_seconds']:.2f}",
        )
    return table


def story(outcome: RaceOutcome) -> Table:
    """The race, one line per round."""
    headings = ("seconds", "measured", "in the race", "chance")
    table = plain_table("leader", *headings, numbers=len(headings))
    for each in outcome.rounds:
        table.add_row(
            each.ranked[0],
            f"{each.spent:.0f}",
            f"{each.measured:,}",
            f"{each.contenders}",
            likelihood(each.probability),
        )
    return table
