"""Write the tables of the guide that follow from the source, between ``<!-- NAME -->`` marks.

``python -m docs.tables`` rewrites them; the tests fail where they are out of date.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from aerocues.exports.targets import TARGETS
from aerocues.results import schema
from aerocues.results.metrics import METRICS
from aerocues.results.reconstruction_schema import RECONSTRUCTION_STATUSES, RECONSTRUCTIONS
from aerocues.results.schema import Column
from aerocues.results.statuses import STATUSES
from aerocues.scoring.criteria import CRITERIA
from aerocues.scoring.settings import SCORE_PRESETS
from aerocues.scoring.weights import WEIGHT_METHODS
from docs import method_tables, tuning_tables

FOLDER = Path(__file__).resolve().parent


def statuses() -> Iterator[tuple[str, ...]]:
    """One row a status."""
    yield "status", "meaning", "measured again by `--retry-failed`"
    for status in STATUSES:
        yield f"`{status.name}`", status.meaning, "yes" if status.retried else ""


def _columns(columns: Iterable[Column]) -> Iterator[tuple[str, ...]]:
    better = {metric.name: f"{metric.better} is better" for metric in METRICS}
    yield "column", "unit", "definition"
    for column in columns:
        definition = column.definition
        if column.name in better:
            definition += f" ({better[column.name]})"
        yield f"`{column.name}`", column.unit, definition


def counts() -> Iterator[tuple[str, ...]]:
    """Columns that count."""
    return _columns(schema.COUNTS)


def metrics() -> Iterator[tuple[str, ...]]:
    """Columns that follow from counts and times."""
    return _columns(schema.DERIVED)


def reference() -> Iterator[tuple[str, ...]]:
    """Columns that the reference of a pair fills."""
    return _columns(schema.REFERENCE)


def ground_truth() -> Iterator[tuple[str, ...]]:
    """Columns that need ground truth."""
    return _columns(schema.GROUND_TRUTH)


def times() -> Iterator[tuple[str, ...]]:
    """Columns of stage times and of what a stage takes."""
    return _columns((*schema.TIMES, *schema.HOW_TIMED, *schema.RESOURCES))


def names() -> Iterator[tuple[str, ...]]:
    """Columns that name a row and tell how it ended."""
    return _columns((*schema.IDENTITY, *schema.OUTCOME))


def provenance() -> Iterator[tuple[str, ...]]:
    """Columns that tell where a row comes from."""
    return _columns(schema.PROVENANCE)


def weight_methods() -> Iterator[tuple[str, ...]]:
    """One row a method of weighting."""
    yield "method", "weight of a criterion before the set is brought to the sum 1", "source"
    for method in WEIGHT_METHODS.values():
        yield f"`{method.name}`", method.description, method.source


def score_presets() -> Iterator[tuple[str, ...]]:
    """One row a preset of scoring."""
    yield "preset", "what it is", "criteria", "weights", "failures"
    for preset in SCORE_PRESETS.values():
        names = ", ".join(f"`{name}`" for name in preset.criteria)
        weights = ", ".join(f"`{name}`" for name in preset.settings.weights)
        yield (
            f"`{preset.name}`",
            preset.description,
            names,
            weights,
            f"`{preset.settings.failures}`",
        )


def criteria() -> Iterator[tuple[str, ...]]:
    """One row a criterion."""
    yield "criterion", "better", "what it is", "of"
    for each in CRITERIA:
        of = "the reconstruction" if each.reconstruction else "each pair"
        yield f"`{each.name}`", each.better, each.description, of


def reconstruction_statuses() -> Iterator[tuple[str, ...]]:
    """One row a status of a reconstruction."""
    yield "status", "meaning", "made again by `--retry-failed`"
    for status in RECONSTRUCTION_STATUSES:
        yield f"`{status.name}`", status.meaning, "yes" if status.retried else ""


def reconstructions() -> Iterator[tuple[str, ...]]:
    """Columns of the figures of reconstructions."""
    return _columns(RECONSTRUCTIONS)


Table = Callable[[], Iterator[tuple[str, ...]]]


def targets() -> Iterator[tuple[str, ...]]:
    """One row a tool that files are written for."""
    yield "`--as`", "what is written", "positions: where the centre of the top-left pixel is"
    for row in TARGETS:
        if row.kind == "files":
            yield f"`{row.name}`", row.title, row.conventions


TABLES: dict[str, tuple[Table, ...]] = {
    "methods.md": (
        method_tables.detectors,
        method_tables.biases,
        method_tables.descriptors,
        method_tables.norms_and_matchers,
        method_tables.extra,
        method_tables.presets,
        method_tables.compatibility,
    ),
    "measuring.md": (statuses,),
    "metrics.md": (counts, metrics, reference, ground_truth, times),
    "reconstruction.md": (reconstruction_statuses, reconstructions),
    "results.md": (names, provenance),
    "tuning.md": (tuning_tables.tuned, tuning_tables.grids),
    "using.md": (targets,),
    "scoring.md": (weight_methods, score_presets, criteria),
}


def as_markdown(rows: Iterator[tuple[str, ...]]) -> str:
    """Rows as a Markdown table; the first one is the head."""
    head, *body = rows
    lines = [head, tuple("---" for _ in head), *body]
    return "\n".join(
        "| " + " | ".join(cell.replace("|", r"\|") for cell in line) + " |" for line in lines
    )


def rendered(page: str) -> str:
    """The text of `page` with its tables as the source has them now."""
    text = (FOLDER / page).read_text(encoding="utf-8")
    for table in TABLES[page]:
        name = table.__name__.replace("_", "-")
        between = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end of {name} -->)", re.DOTALL)
        place = between.search(text)
        if place is None:
            raise SystemExit(f"docs/{page} has no place for the table {name}")
        table_text = f"{place[1]}{as_markdown(table())}\n{place[2]}"
        text = text[: place.start()] + table_text + text[place.end() :]
    return text


if __name__ == "__main__":
    for page in TABLES:
        (FOLDER / page).write_text(rendered(page), encoding="utf-8")
