"""The output of a choice from finished measurements."""

from __future__ import annotations

import textwrap
from collections import Counter
from typing import TYPE_CHECKING, Any

from aerocues.cli.console import plain_table, print_table, standard_output
from aerocues.phrases import count, likelihood

if TYPE_CHECKING:
    from rich.table import Table

    from aerocues.tuning.choice import Choice

WIDTH = 100
SURE = 0.95
MOST_NAMED = 6
COSTS = {
    "total_seconds": ("seconds", ".3f"),
    "peak_memory_mb": ("MB", ".0f"),
    "descriptor_bytes": ("bytes", ".0f"),
}


def print_choice(found: Choice, top: int) -> None:
    """Print what to take, how sure that is, and the table of the best."""
    console = standard_output()
    for paragraph in (f"Take {found.best}.", _certainty(found), _left_out(found)):
        if paragraph:
            console.print(textwrap.fill(paragraph, WIDTH, break_on_hyphens=False), markup=False)
    console.print()
    print_table(console, _ranking(found, top))
    if len(found.ranked) > top:
        console.print(f"best {top} of {len(found.ranked):,}; --top shows more")
    told = dict.fromkeys(found.presets)
    medians = "; seconds are medians" if "total_seconds" in _costs(found, top) else ""
    console.print(
        f"objective {found.objective.name}: {found.objective.definition}\nscoring preset "
        f"{', '.join(told)}; a failed pair counts as the worst{medians}",
        markup=False,
    )


def _certainty(found: Choice) -> str:
    """How sure the first is the best, and who else may be."""
    ranked = found.ranked
    first = ranked["probability"][0]
    on = f"{count(found.pairs, 'pair')} of {', '.join(dict.fromkeys(found.datasets))}"
    told = f"It has the highest score of {count(len(ranked), 'combination')} for "
    told += f"{found.objective.title} on {on}"
    if first is None:
        return f"{told}; with a single pair nothing tells how sure that is."
    told += (
        f", and is the best with a probability of {likelihood(float(first))} when the pairs are "
        "drawn anew."
    )
    likely = ranked[1:].filter(ranked[1:]["probability"] >= 1 - SURE)["combination"].to_list()
    if likely:
        more = f" and {len(likely) - MOST_NAMED} more" if len(likely) > MOST_NAMED else ""
        told += f" {', '.join(likely[:MOST_NAMED])}{more} could equally be the best."
    return told


def _left_out(found: Choice) -> str:
    if not found.excluded:
        return ""
    kinds = Counter(why.partition(":")[0] for why in found.excluded.values())
    reasons = ", ".join(f"{number:,} ({kind})" for kind, number in kinds.most_common())
    return f"Left out: {reasons}."


def _costs(found: Choice, top: int) -> list[str]:
    """Columns of costs that the table has: those that are known of any of the best."""
    shown = found.ranked.head(top)
    return [name for name in COSTS if shown[name].is_not_null().any()]


def _ranking(found: Choice, top: int) -> Table:
    shown, costs = found.ranked.head(top), _costs(found, top)
    own = [name for name in shown.columns if name.startswith("score_")]
    headings = ["score", "best in", "success", *(COSTS[name][0] for name in costs)]
    headings += [name.removeprefix("score_") for name in own]
    output = plain_table("rank", "combination", *headings, numbers=len(headings), gap=1)
    output.columns[0].justify, output.columns[1].no_wrap = "right", True
    for rank, row in enumerate(shown.iter_rows(named=True), start=1):
        chance = row["probability"]
        output.add_row(
            str(rank),
            row["combination"],
            f"{row['score']:.3f}",
            "-" if chance is None else likelihood(chance),
            f"{100 * row['success_rate']:.0f} %",
            *("-" if row[name] is None else f"{row[name]:{COSTS[name][1]}}" for name in costs),
            *(f"{row[name]:.3f}" for name in own),
        )
    return output


def choice_facts(found: Choice) -> dict[str, Any]:
    """A choice as plain values."""
    return {
        "best": found.best,
        "objective": found.objective.name,
        "datasets": list(found.datasets),
        "presets": list(found.presets),
        "pairs": found.pairs,
        "ranking": found.ranked.to_dicts(),
        "excluded": dict(found.excluded),
    }
