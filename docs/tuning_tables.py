"""Tables of the guide about tuning: what is searched, and what was found."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from aerocues.methods.preset_files import tuned_record
from aerocues.tuning.grids import GRIDS
from docs.method_tables import parameters_text


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
        *("inliers", "right matches", "share right"),
    )
    for part in tuned_record()["made"]:
        for search in part["searches"]:
            yield _searched(search)


def _searched(search: Mapping[str, Any]) -> tuple[str, ...]:
    if search["default"] is None:
        return (search["search_space"], "default", "", *("",) * 4)
    low, high = search["interval"]
    before, after = search["default"], search["tuned"]
    figures = ((before[name], after[name]) for name in ("inliers", "right_matches", "right_share"))
    return (
        search["search_space"],
        parameters_text({name: _constant(value) for name, value in search["best"].items()}),
        "yes" if search["kept"] else "no",
        f"{search['gain']:+.3f} ({low:+.3f} to {high:+.3f})",
        *(
            "" if None in (old, new) else f"{old:{form}} to {new:{form}}"
            for (old, new), form in zip(figures, (",.0f", ",.0f", ".2f"), strict=True)
        ),
    )
