"""A ranking by CUES, as a table that fits 100 columns and as JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from aerocues.cli.console import count, plain_table, print_table, standard_output

if TYPE_CHECKING:
    from rich.table import Table

    from aerocues.scoring.measured import MeasuredTable
    from aerocues.scoring.ranking import Ranking
    from aerocues.scoring.table import DecisionTable

SHOWN = 3
NAMED = 8
# What of the criteria is shown, the first ones that were chosen; and under which heading.
HEADINGS: dict[str, str] = {
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
    """The whole ranking as JSON has it."""
    weights = ranking.weights().to_dicts()
    return {
        "ranking": ranking.frame("combination").to_dicts(),
        "weights": {row.pop("criterion"): row for row in weights},
        "settings": {
            "dataset": measured.dataset,
            "preset": measured.preset.name,
            **ranking.settings(),
        },
        "indistinguishable_from_best": ranking.indistinguishable(),
        "unscored": ranking.unscored(),
    }


def print_scores(ranking: Ranking, measured: MeasuredTable, top: int) -> None:
    """Print the best `top`, the weights of the criteria and how both came about."""
    from rich.text import Text

    print_best(ranking, measured, top)
    console = standard_output()
    console.print(Text("\nweights of the criteria", style="bold"))
    print_table(console, _weights(ranking))
    preset = measured.preset
    console.print(Text(f"\npreset {preset.name}: {preset.description}", style="dim"))


def print_best(ranking: Ranking, measured: MeasuredTable, top: int) -> None:
    """Print the best `top` and what may be said of them."""
    from rich.text import Text

    console = standard_output()
    number = len(ranking.scores.order)
    shown = f"best {top} of " if top < number else ""
    pairs = count(len(ranking.scores.table.repeats), "pair")
    line = f"{measured.dataset}: {shown}{count(number, 'combination')} on {pairs}"
    console.print(Text(line, style="bold"))
    print_table(console, _best(ranking, measured, top))
    for note in _notes(ranking):
        console.print(Text(note, style="dim"))


def _best(ranking: Ranking, measured: MeasuredTable, top: int) -> Table:
    table = ranking.scores.table
    frame = ranking.frame("combination").head(top)
    timed = any(name in measured.seconds for name in frame["combination"])
    room = SHOWN - timed
    shown = [name for name in HEADINGS if name in table.criterion_names][:room]
    shown = shown or list(table.criterion_names[:room])
    headings = ["\nCUES", "95 %\ninterval", "95 %\nranks", "best\nin", "\nsuccess"]
    headings += [HEADINGS.get(name, f"\n{name}") for name in shown]
    headings += ["seconds\na pair"] if timed else []
    uneven = bool((frame["repeats"] < len(table.repeats)).any())
    headings += ["\npairs"] if uneven else []
    output = plain_table("\nrank", "\ncombination", *headings, numbers=len(headings), gap=1)
    output.columns[0].justify, output.columns[1].no_wrap = "right", True
    for row in frame.iter_rows(named=True):
        output.add_row(
            f"{row['rank']}",
            row["combination"],
            f"{row['score']:.3f}",
            f"{row['score_low']:.3f}-{row['score_high']:.3f}",
            _span(row["rank_low"], row["rank_high"]),
            f"{100 * row['probability_best']:.0f} %",
            f"{100 * row['success_rate']:.0f} %",
            *(_number(row[name]) for name in shown),
            *([_number(measured.seconds.get(row["combination"]))] if timed else []),
            *([f"{row['repeats']:,}"] if uneven else []),
        )
    return output


def _span(low: int | None, high: int | None) -> str:
    return "-" if low is None else f"{low}" if low == high else f"{low}-{high}"


def _number(value: float | None) -> str:
    if value is None:
        return "-"
    return (
        f"{value:,.0f}"
        if abs(value) >= 100
        else f"{value:.3f}"
        if abs(value) < 10
        else f"{value:.1f}"
    )


def _notes(ranking: Ranking) -> list[str]:
    table, settings = ranking.scores.table, ranking.settings()
    failed = (
        "A failed pair counts as the worst"
        if settings["failures"] == "worst"
        else "Failed pairs are left out"
    )
    unit = _unit(table, settings["resampled"])
    drawn = f"intervals from {settings['resamples']:,} resamples of {unit}"
    lines = [f"{failed}; criteria are means over the pairs that succeeded; {drawn}."]
    if any("beyond_chance" in name or "excess" in name for name in table.criterion_names):
        lines.append("* beyond those that the same matches give when shuffled.")
    alike = ranking.indistinguishable()
    names = ", ".join(alike[:NAMED])
    more = f" and {len(alike) - NAMED} more" if len(alike) > NAMED else ""
    best = table.alternatives[ranking.scores.best]
    told = f"cannot be told from {best} on these pairs: {names}{more}"
    lines.append(told if alike else f"{best} is better than every other one (corrected p < 0.05)")
    fewer = int((table.tried[ranking.scores.order] < len(table.repeats)).sum())
    if fewer:
        lines.append(f"{count(fewer, 'combination')} on fewer pairs than all: scored on their own.")
    unscored = ranking.unscored()
    if unscored:
        without = f"{', '.join(unscored[:3])}{', ...' if len(unscored) > 3 else ''}"
        lines.append(f"without a score, as they lack a criterion: {len(unscored)} ({without})")
    return lines


def _unit(table: DecisionTable, unit: str) -> str:
    blocks = len(set(table.blocks.tolist()))
    if unit == "block":
        return f"the {blocks} sequences"
    few = 1 < blocks < len(table.repeats)
    return f"pairs ({blocks} sequences are too few)" if few else "pairs"


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
