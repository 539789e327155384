"""Tables of the guide about methods: what there is, its parameters, what fits together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping

from aerocues.methods.compatibility import incompatibility, why_meaningless
from aerocues.methods.descriptors import DESCRIPTORS
from aerocues.methods.detectors import DETECTORS
from aerocues.methods.extra import EXTRA_DESCRIPTORS, EXTRA_DETECTORS, EXTRA_MATCHERS
from aerocues.methods.matchers import MATCHERS, NORMS
from aerocues.methods.pair_matchers import PIXELMAP
from aerocues.methods.presets import preset_named, preset_names
from aerocues.methods.registry import opencv_methods


def parameters_text(parameters: Mapping[str, object]) -> str:
    """Parameters as the tables show them."""
    return ", ".join(f"{name}={value}" for name, value in parameters.items()) or "none"


def detectors() -> Iterator[tuple[str, ...]]:
    """One row a detector."""
    yield "detector", "parameters", "source"
    for row in DETECTORS:
        yield f"`{row.name}`", parameters_text(row.parameters), row.reference


def biases() -> Iterator[tuple[str, ...]]:
    """One row a detector that OpenCV shifts."""
    yield "detector", "how OpenCV shifts its keypoints", "what puts them right"
    for row in DETECTORS:
        if row.bias:
            yield f"`{row.name}`", row.bias, parameters_text(row.unbiased)


def descriptors() -> Iterator[tuple[str, ...]]:
    """One row a descriptor."""
    yield "descriptor", "elements", "parameters", "source"
    for row in DESCRIPTORS:
        elements = f"{row.columns} {row.dtype}"
        yield f"`{row.name}`", elements, parameters_text(row.parameters), row.reference


def norms_and_matchers() -> Iterator[tuple[str, ...]]:
    """One row a norm, one row a matcher."""
    yield "name", "kind", "what it is", "parameters"
    for norm in NORMS:
        yield f"`{norm.name}`", "norm", norm.title, ""
    for row in MATCHERS:
        by_norm = (f"{norm}: {parameters_text(values)}" for norm, values in row.parameters.items())
        yield f"`{row.name}`", "matcher", row.title, "; ".join(by_norm)


def extra() -> Iterator[tuple[str, ...]]:
    """One row a method of the set `extra`."""
    yield "name", "kind", "what it is", "parameters", "source"
    classic = DETECTORS[0].parameters.items()
    for one in EXTRA_DETECTORS:
        own = parameters_text(dict(one.parameters.items() - classic))
        yield f"`{one.name}`", "detector", one.factory, own, one.reference
    for other in EXTRA_DESCRIPTORS:
        yield f"`{other.name}`", "descriptor", f"root of {other.factory}", "", other.reference
    for row in (*EXTRA_MATCHERS, PIXELMAP):
        kind = "pair matcher" if row.of_pairs else "matcher"
        own = parameters_text(next(iter(row.parameters.values())))
        yield f"`{row.name}`", kind, row.title, own, row.reference


def presets() -> Iterator[tuple[str, ...]]:
    """One row a preset."""
    yield "preset", "what it is", "chance test"
    for preset in map(preset_named, preset_names()):
        yield f"`{preset.name}`", preset.title, "yes" if preset.chance_test else "no"


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
