"""Write the tables of the guide that follow from the source, between ``<!-- NAME -->`` marks.

``python docs/tables.py`` rewrites them; the tests fail where they are out of date.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from aerocues.exports.targets import TARGETS
from aerocues.methods.compatibility import incompatibility, why_meaningless
from aerocues.methods.descriptors import DESCRIPTORS
from aerocues.methods.detectors import DETECTORS
from aerocues.methods.extra import EXTRA_DESCRIPTORS, EXTRA_DETECTORS, EXTRA_MATCHERS
from aerocues.methods.matchers import MATCHERS, NORMS
from aerocues.methods.pair_matchers import PIXELMAP
from aerocues.methods.preset_files import tuned_record
from aerocues.methods.presets import preset_named, preset_names
from aerocues.methods.registry import opencv_methods
from aerocues.results import schema
from aerocues.results.metrics import METRICS
from aerocues.results.reconstruction_schema import RECONSTRUCTION_STATUSES, RECONSTRUCTIONS
from aerocues.results.schema import Column
from aerocues.results.statuses import STATUSES
from aerocues.scoring.criteria import CRITERIA
from aerocues.scoring.settings import SCORE_PRESETS
from aerocues.scoring.weights import WEIGHT_METHODS
from aerocues.tuning.grids import GRIDS

FOLDER = Path(__file__).resolve().parent


def _parameters(parameters: Mapping[str, object]) -> str:
    return ", ".join(f"{name}={value}" for name, value in parameters.items()) or "none"


def detectors() -> Iterator[tuple[str, ...]]:
    """One row a detector."""
    yield "detector", "parameters", "source"
    for row in DETECTORS:
        yield f"`{row.name}`", _parameters(row.parameters), row.reference


def biases() -> Iterator[tuple[str, ...]]:
    """One row a detector that OpenCV shifts."""
    yield "detector", "how OpenCV shifts its keypoints", "what puts them right"
    for row in DETECTORS:
        if row.bias:
            yield f"`{row.name}`", row.bias, _parameters(row.unbiased)


def descriptors() -> Iterator[tuple[str, ...]]:
    """One row a descriptor."""
    yield "descriptor", "elements", "parameters", "source"
    for row in DESCRIPTORS:
        elements = f"{row.columns} {row.dtype}"
        yield f"`{row.name}`", elements, _parameters(row.parameters), row.reference


def norms_and_matchers() -> Iterator[tuple[str, ...]]:
    """One row a norm, one row a matcher."""
    yield "name", "kind", "what it is", "parameters"
    for norm in NORMS:
        yield f"`{norm.name}`", "norm", norm.title, ""
    for row in MATCHERS:
        by_norm = (f"{norm}: {_parameters(values)}" for norm, values in row.parameters.items())
        yield f"`{row.name}`", "matcher", row.title, "; ".join(by_norm)


def extra() -> Iterator[tuple[str, ...]]:
    """One row a method of the set `extra`."""
    yield "name", "kind", "what it is", "parameters", "source"
    classic = DETECTORS[0].parameters.items()
    for one in EXTRA_DETECTORS:
        own = _parameters(dict(one.parameters.items() - classic))
        yield f"`{one.name}`", "detector", one.factory, own, one.reference
    for other in EXTRA_DESCRIPTORS:
        yield f"`{other.name}`", "descriptor", f"root of {other.factory}", "", other.reference
    for row in (*EXTRA_MATCHERS, PIXELMAP):
        kind = "pair matcher" if row.of_pairs else "matcher"
        own = _parameters(next(iter(row.parameters.values())))
        yield f"`{row.name}`", kind, row.title, own, row.reference


def presets() -> Iterator[tuple[str, ...]]:
    """One row a preset."""
    yield "preset", "what it is", "chance test"
    for preset in map(preset_named, preset_names()):
        yield f"`{preset.name}`", preset.title, "yes" if preset.chance_test else "no"


def grids() -> Iterator[tuple[str, ...]]:
    """One row a method that can be tuned."""
    yield "method", "judged with", "values", "on each detector"
    for row in GRIDS:
        yield (
            f"{row.kind} `{row.method}`",
            f"`{row.partner}`",
            _values(row.values),
            _values(row.on_each_detector),
        )


def _values(values: Mapping[str, tuple[object, ...]]) -> str:
    return "; ".join(
        f"{name}: {', '.join(map(_constant, tried))}" for name, tried in values.items()
    )


def _constant(value: object) -> str:
    """A value; of a constant the name without its class."""
    return value.rpartition(".")[2] if isinstance(value, str) else str(value)


def tuned() -> Iterator[tuple[str, ...]]:
    """One row a search of the preset `tuned`."""
    yield (
        *("searched", "best setting", "used", "gain in CUES (95 %)"),
        *("inlier ratio", "inliers", "true precision"),
    )
    for part in tuned_record()["made"]:
        for search in part["searches"]:
            yield _searched(search)


def _searched(search: Mapping[str, Any]) -> tuple[str, ...]:
    if search["default"] is None:
        return (search["search_space"], "default", "", *("",) * 4)
    low, high = search["interval"]
    before, after = search["default"], search["tuned"]
    figures = (
        (before[name], after[name]) for name in ("inlier_ratio", "inliers", "true_precision")
    )
    return (
        search["search_space"],
        _parameters({name: _constant(value) for name, value in search["best"].items()}),
        _used(search),
        f"{search['gain']:+.3f} ({low:+.3f} to {high:+.3f})",
        *(
            "" if None in (old, new) else f"{old:{form}} to {new:{form}}"
            for (old, new), form in zip(figures, (".2f", ",.0f", ".2f"), strict=True)
        ),
    )


def _used(search: Mapping[str, Any]) -> str:
    """Whether a setting is used, and whether it still would be with an interval twice as wide.

    Records without the scenes that judged are of a time when intervals came from resamples of the
    pairs: over the scenes, Student's t is about twice as wide.
    """
    if not search["kept"]:
        return "no"
    wider = 1.0 if "judged_by" in search else 2.0
    gain, low = search["gain"], search["interval"][0]
    return "yes" if gain - wider * (gain - low) > 0 else "yes, not sure"


def compatibility() -> Iterator[tuple[str, ...]]:
    """Combinations by the reason for which they do not run, or run but mean nothing."""
    methods = opencv_methods()
    counts: Counter[str] = Counter()
    examples: dict[str, str] = {}
    for combination in methods.combinations():
        found = incompatibility(combination, methods)
        if found:
            cause = found[0]
        elif why_meaningless(combination, methods):
            cause = "runs, but the L2 norm of strings of bits means nothing"
        else:
            cause = "runs and means something: the default selection"
        counts[cause] += 1
        examples.setdefault(cause, str(combination))
    yield "what happens", "combinations", "for instance"
    for cause, count in sorted(counts.items(), key=lambda item: item[1]):
        yield cause, str(count), f"`{examples[cause]}`"
    yield "**declared in all**", f"**{counts.total()}**", ""


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
        *(detectors, biases, descriptors, norms_and_matchers, extra, presets, compatibility),
    ),
    "measuring.md": (statuses,),
    "metrics.md": (counts, metrics, reference, ground_truth, times),
    "reconstruction.md": (reconstruction_statuses, reconstructions),
    "results.md": (names, provenance),
    "tuning.md": (tuned, grids),
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
