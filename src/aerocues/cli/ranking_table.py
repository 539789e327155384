"""A ranking by CUES, as a table of 100 columns and as JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from aerocues.cli.console import plain_table, print_table, standard_output
from aerocues.cli.ranking_notes import mixed_machines, notes
from aerocues.phrases import count

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.table import Table

    from aerocues.scoring.measured import MeasuredTable
    from aerocues.scoring.ranking import Ranking

SHOWN = 3
WIDE = 96
RANK_WIDTH = 4
# Criteria that the table may show, in order of priority, and their headings.
HEADINGS: dict[str, str] = {
    "ref_precision@3": "share\nright",
    "ref_matches@3": "right\nmatches",
    "coverage": "\ncoverage",
    "sharpness": "\nsharp",
    "seconds_per_1k_ref_matches": "s / 1k\nright",
    "precision_beyond_chance": "inlier\nratio*",
    "precision": "inlier\nratio",
    "excess_inliers": "\ninliers*",
    "inliers": "\ninliers",
    "seconds_per_1k_excess_inliers": "s / 1k\ninliers*",
    "seconds_per_1k_inliers": "s / 1k\ninliers",
    "recall_beyond_chance": "\nrecall*",
    "repeatability_beyond_chance": "repeat-\nability*",
    "repeatability": "repeat-\nability",
    "f1_beyond_chance": "\nF1*",
    "f1_score": "\nF1",
    "seconds_per_1k_matches": "s / 1k\nmatches",
    "seconds_per_1k_keypoints": "s / 1k\nkeypoints",
    "reprojection_error": "reproj.\nerror",
    "reconstruction_seconds": "model\nseconds",
    "points_3d": "3D\npoints",
}


def facts(ranking: Ranking, measured: MeasuredTable) -> dict[str, Any]:
    """The whole ranking for JSON."""
    weights = ranking.weights().to_dicts()
    return {
        "ranking": ranking.frame("combination").to_dicts(),
        "weights": {row.pop("criterion"): row for row in weights},
        "settings": {
            "dataset": measured.dataset,
            "preset": measured.preset.name,
            **ranking.settings(),
        },
        "indistinguishable": ranking.indistinguishable(),
        "untested": ranking.untested(),
        "unscored": ranking.unscored(),
    }


def print_scores(ranking: Ranking, measured: MeasuredTable, top: int) -> None:
    """Print the best `top`, the weights of the criteria and the settings."""
    from rich.text import Text

    print_best(ranking, measured, top)
    console = standard_output()
    console.print(Text("\nweights of the criteria", style="bold"))
    print_table(console, _weights(ranking))
    preset = measured.preset
    console.print(Text(f"\npreset {preset.name}: {preset.description}", style="dim"))


def print_best(ranking: Ranking, measured: MeasuredTable, top: int) -> None:
    """Print the best `top`, with notes."""
    from rich.text import Text

    console = standard_output()
    number = len(ranking.scores.order)
    shown = f"best {top} of " if top < number else ""
    pairs = count(len(ranking.scores.table.repeats), "pair")
    line = f"{measured.dataset}: {shown}{count(number, 'combination')} on {pairs}"
    console.print(Text(line, style="bold"))
    print_table(console, _best(ranking, measured, top))
    for note in (*notes(ranking), *mixed_machines(measured)):
        console.print(Text(note, style="dim"))


def _best(ranking: Ranking, measured: MeasuredTable, top: int) -> Table:
    table = ranking.scores.table
    frame = ranking.frame("combination").head(top)
    timed = any(name in measured.seconds for name in frame["combination"])
    shown = _shown(table.criterion_names, timed=timed)
    headings = ["\nCUES", "95 %\ninterval", "95 %\nranks", "best\nin", "\nsuccess"]
    headings += [HEADINGS.get(name, f"\n{name}") for name in shown]
    headings += ["seconds\na pair"] if timed else []
    uneven = bool((frame["repeats"] < len(table.repeats)).any())
    headings += ["\npairs"] if uneven else []
    output = plain_table("\nrank", "\ncombination", *headings, numbers=len(headings), gap=1)
    output.columns[0].justify, output.columns[0].min_width = "right", RANK_WIDTH
    output.columns[0].no_wrap = output.columns[1].no_wrap = True
    for row in frame.iter_rows(named=True):
        output.add_row(
            f"{row['rank']}",
            row["combination"],
            f"{row['score']:.3f}",
            _between(row["score_low"], row["score_high"]),
            _span(row["rank_low"], row["rank_high"]),
            _percent(row["probability_best"]),
            _percent(row["success_rate"]),
            *(_number(row[name]) for name in shown),
            *([_number(measured.seconds.get(row["combination"]))] if timed else []),
            *([f"{row['repeats']:,}"] if uneven else []),
        )
    return output


def _shown(criteria: Sequence[str], *, timed: bool) -> list[str]:
    """Criteria that fit into the table beside the seconds."""
    room = (SHOWN if standard_output().width >= WIDE else 1) - timed
    known = [name for name in HEADINGS if name in criteria]
    return (known or list(criteria))[:room]


def _between(low: float | None, high: float | None) -> str:
    return "-" if low is None else f"{low:.3f}-{high:.3f}"


def _span(low: int | None, high: int | None) -> str:
    return "-" if low is None else f"{low}" if low == high else f"{low}-{high}"


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.0f} %"


def _number(value: float | None) -> str:
    if value is None:
        return "-"
    digits = 0 if abs(value) >= 100 else 1 if abs(value) >= 10 else 3
    return f"{value:,.{digits}f}"


def _weights(ranking: Ranking) -> Table:
    frame = ranking.weights()
    methods = frame.columns[1:]
    titles = [method.replace("_", "\n") if "_" in method else f"\n{method}" for method in methods]
    output = plain_table("\ncriterion", *titles, numbers=len(methods))
    costs = {
        criterion.name: criterion.better == "lower" for criterion in ranking.scores.table.criteria
    }
    for row in frame.iter_rows(named=True):
        name = row["criterion"]
        label = f"{name} (cost)" if costs[name] else name
        output.add_row(label, *(f"{row[method]:.3f}" for method in methods))
    return output
