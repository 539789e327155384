"""The output of `aerocues validate`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from aerocues.cli.console import plain_table, print_table, standard_output
from aerocues.cli.ranking_table import HEADINGS
from aerocues.phrases import count

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from rich.console import Console
    from rich.table import Table

    from aerocues.scoring.cues import Scores
    from aerocues.scoring.friedman import CriticalDifference
    from aerocues.scoring.measured import MeasuredTable
    from aerocues.scoring.validation import Validation

WIDE = 96
LISTED = ("detectors", "descriptors", "norms", "matchers", "detector-descriptor pairs")


def print_validation(scores: Scores, found: Validation, measured: MeasuredTable, top: int) -> None:
    """Print all sections, each with a title that explains it."""
    from aerocues.scoring.resampling import unit_of_resampling

    console = standard_output()
    best = scores.table.alternatives[scores.best]
    scored = count(len(scores.order), "combination")
    on = count(len(scores.table.repeats), "pair")
    named = f"{measured.dataset}: {scored} on {on}, preset {measured.preset.name}"
    print_title(console, f"{named}; the best: {best}")
    print_title(console, "\npower alpha: Spearman's correlation of the rankings")
    print_table(console, matrix_table(found.alpha.names, found.alpha.correlation, found.alpha.best))
    print_title(console, "\naggregation of the weights: Spearman's correlation of the rankings")
    each = found.aggregation
    print_table(console, matrix_table(each.names, each.correlation, each.best))
    print_title(
        console, "\ncriteria left out: Spearman's correlation with the ranking by all criteria"
    )
    print_table(console, _left_out(found))
    print_title(console, "\nother methods, same criteria and weights: Spearman's correlation")
    if isinstance(found.agreement, str):
        console.print(found.agreement)
    else:
        methods = found.agreement
        print_table(console, matrix_table(methods.names, methods.correlation, methods.best))
    print_title(
        console, "\ncriteria: Pearson's correlation over the combinations (costs not inverted)"
    )
    print_table(console, numbered_matrix(scores.table.criterion_names, found.criteria_correlation))
    _print_hierarchies(console, found, top)
    _print_matcher_times(console, found)
    _print_pareto(console, scores, found)
    _print_rank_reversal(console, found)
    unit = "sequence" if unit_of_resampling(scores.table) == "block" else "pair"
    _print_critical_difference(console, found.critical_difference, unit)


def print_title(console: Console, text: str) -> None:
    """Print the title of a table."""
    from rich.text import Text

    console.print(Text(text, style="bold"))


def correlation_text(value: float) -> str:
    """A correlation with three digits; a dash if undefined."""
    return "-" if value != value else f"{value:.3f}"


def matrix_table(
    names: Sequence[str], values: NDArray[Any], best: Sequence[str] | None = None
) -> Table:
    """A matrix with names on both sides, and the best of each ranking."""
    if standard_output().width < WIDE:
        return numbered_matrix(names, values)
    headings = [*names, *(["the best"] if best else [])]
    output = plain_table("", *headings, numbers=len(headings))
    output.columns[0].no_wrap = True
    if best:
        output.columns[-1].justify = "left"
    for position, name in enumerate(names):
        cells = [correlation_text(value) for value in values[position]]
        output.add_row(name, *cells, *([best[position]] if best else []))
    return output


def numbered_matrix(names: Sequence[str], values: NDArray[Any], digits: int = 2) -> Table:
    """A matrix with numbered columns, for names too long for headings."""
    numbers = [str(number + 1) for number in range(len(names))]
    output = plain_table("", "", *numbers, numbers=len(numbers), gap=1)
    output.columns[1].no_wrap = True
    for position, name in enumerate(names):
        cells = [f"{value:.{digits}f}" if value == value else "-" for value in values[position]]
        output.add_row(numbers[position], name, *cells)
    return output


def _left_out(found: Validation) -> Table:
    left_out = found.criterion_left_out
    output = plain_table("", "correlation", "the best", numbers=2)
    output.columns[-1].justify = "left"
    for position, name in enumerate(left_out.names[1:], start=1):
        value = correlation_text(left_out.correlation[0, position])
        output.add_row(name, value, left_out.best[position])
    return output


def _print_hierarchies(console: Console, found: Validation, top: int) -> None:
    for component in LISTED:
        frame = found.hierarchies.get(component)
        if frame is None:
            continue
        shown = frame.head(top) if component == LISTED[-1] else frame
        more = f": best {len(shown)} of {len(frame)}" if len(shown) < len(frame) else ""
        print_title(console, f"\n{component} by mean CUES{more}")
        headings = ("mean", "max", "std", "evaluations", "the best")
        output = plain_table("", *headings, numbers=len(headings))
        output.columns[0].no_wrap, output.columns[-1].justify = True, "left"
        for row in shown.iter_rows(named=True):
            output.add_row(
                row["name"],
                f"{row['mean']:.3f}",
                f"{row['max']:.3f}",
                f"{row['standard_deviation']:.3f}",
                f"{row['evaluations']:,}",
                row["best"],
            )
        print_table(console, output)


def _print_matcher_times(console: Console, found: Validation) -> None:
    for component, frame in found.matcher_times.items():
        cost = found.pareto_criteria[0]
        print_title(console, f"\n{component}: {cost} with other matchers than brute force")
        output = plain_table("", "matcher", "combinations", "BF", "other", "ratio", numbers=5)
        output.columns[0].no_wrap, output.columns[1].justify = True, "left"
        for row in frame.iter_rows(named=True):
            output.add_row(
                row["name"],
                row["matcher"],
                f"{row['combinations']:,}",
                *(f"{row[name]:.3g}" for name in ("brute_force", "other")),
                f"{row['ratio']:.2f}",
            )
        print_table(console, output)


def _print_pareto(console: Console, scores: Scores, found: Validation) -> None:
    if not found.pareto_criteria:
        return
    print_title(console, f"\nPareto front of {' and '.join(found.pareto_criteria)}")
    chosen = [scores.table.criterion_names.index(name) for name in found.pareto_criteria]
    titles = [HEADINGS.get(name, name).lstrip("\n") for name in found.pareto_criteria]
    output = plain_table("", *titles, "success", "rank", numbers=4)
    output.columns[0].no_wrap = True
    for position in found.pareto_front:
        values = [f"{scores.means[position, column]:.3f}" for column in chosen]
        success = f"{100 * scores.table.success_rate[position]:.0f} %"
        name = scores.table.alternatives[position]
        output.add_row(name, *values, success, f"{scores.ranks[position]:.0f}")
    print_table(console, output)


def _print_rank_reversal(console: Console, found: Validation) -> None:
    if found.rank_reversal is None:
        return
    each = found.rank_reversal
    print_title(console, f"\nrank reversal: {100 * each.share:.0f} % of the combinations removed")
    console.print(
        f"in {each.rounds} rounds the remaining ones moved by {each.mean_shift:.2f} places on "
        f"average, by {each.largest_shift:.0f} at most;\nthe best of them stayed the best in "
        f"{100 * each.best_kept:.0f} %; Spearman's correlation "
        f"{correlation_text(each.spearman_mean)} on average, "
        f"{correlation_text(each.spearman_lowest)} at least"
    )


def _print_critical_difference(
    console: Console, found: CriticalDifference | str, unit: str
) -> None:
    print_title(console, "\nmean ranks of the best over the pairs (Friedman, Nemenyi)")
    if isinstance(found, str):
        console.print(found)
        return
    output = plain_table("", "mean rank", "groups", numbers=1)
    output.columns[1].justify = "right"
    for position, name in enumerate(found.alternatives):
        bars = "".join("|" if first <= position <= last else " " for first, last in found.groups)
        output.add_row(name, f"{found.mean_ranks[position]:.2f}", bars)
    print_table(console, output)
    console.print(
        f"Friedman's chi-square {found.chi_square:.1f} over {found.units} {unit}s, p = "
        f"{found.p_value:.2g}; mean ranks that differ\nby less than "
        f"{found.critical_difference:.2f} (joined by a bar) are not significantly different"
    )
