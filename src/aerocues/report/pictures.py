"""Pictures of keypoints and matches, by repeating the measurement."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from aerocues.errors import AerocuesError, ImageError
from aerocues.evaluation.unit import Context
from aerocues.methods.combination import Combination
from aerocues.report.arrays import packed_bytes, packed_floats
from aerocues.report.choice import Choice, chosen_pictures
from aerocues.report.drawing_process import DrawingProcess
from aerocues.report.drawn_matches import DrawnMatches
from aerocues.report.entry import ReportEntry
from aerocues.report.reopening import context_of
from aerocues.report.thumbnails import thumbnail
from aerocues.results.combination_columns import combination_name

MOST_KEYPOINTS = 1500
MOST_MATCHES = 500
# Time limit of a repetition: this multiple of the measured time plus these seconds.
PATIENCE = 10.0
START_SECONDS = 60.0
FIGURES = (
    *("status", "keypoints_1", "keypoints_2", "matches", "inliers", "precision"),
    *("precision_beyond_chance", "ref_precision@3", "gt_precision@3", "total_seconds"),
)
STAGES = (
    *("detect_seconds_1", "detect_seconds_2", "describe_seconds_1", "describe_seconds_2"),
    *("match_seconds", "verify_seconds"),
)
Row = Mapping[str, Any]


@dataclass
class Pictures:
    """Pictures with their images, the most important first, and notes."""

    images: dict[str, dict[str, Any]] = field(default_factory=dict)
    pictures: list[dict[str, Any]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


class _UnrepeatableError(Exception):
    """A picture cannot be drawn; the message says why."""


def pictures_of(
    found: ReportEntry,
    number: int,
    moved: Sequence[str] = (),
    told: Callable[[str], None] = lambda _: None,
) -> Pictures:
    """Draw pictures of the best combinations of an entry.

    Parameters
    ----------
    found : ReportEntry
    number : int
        Number of combinations to show.
    moved : sequence of str
        New locations of images that have moved; see `reopening.context_of`.
    told : callable
        Called with a short description of each step.
    """
    result = Pictures()
    try:
        context = context_of(found, moved)
    except AerocuesError as error:
        result.notes.append(f"{found.name}: no pictures: {error}")
        return result
    choices = chosen_pictures(found, number)
    drawn: dict[Choice, dict[str, Any]] = {}
    with DrawingProcess(context) as process:
        # Combinations on the same pair share features.
        for choice in sorted(choices, key=lambda each: [c.pair for c in choices].index(each.pair)):
            told(f"drawing {choice.combination} on pair {choice.pair} of {found.name}")
            try:
                drawn[choice] = _picture(found, process, choice)
                _add_images(result, found, context, choice)
            except (_UnrepeatableError, ImageError) as error:
                drawn.pop(choice, None)
                what = f"{choice.combination} on pair {choice.pair}"
                result.notes.append(f"{found.name}: no picture of {what}: {error}")
    result.pictures += [drawn[choice] for choice in choices if choice in drawn]
    return result


def _image_key(found: ReportEntry, name: str) -> str:
    return f"{found.name}/{name}"


def _add_images(result: Pictures, found: ReportEntry, context: Context, choice: Choice) -> None:
    pair = context.dataset.pair(choice.pair)
    for name in (pair.image_1, pair.image_2):
        key = _image_key(found, name)
        if key not in result.images:
            result.images[key] = thumbnail(context.dataset.image(name)).facts()


def _picture(found: ReportEntry, process: DrawingProcess, choice: Choice) -> dict[str, Any]:
    """One picture of the payload; raises _UnrepeatableError if it cannot be drawn."""
    row = _measured_row(found, choice)
    seconds = sum(row[stage] or 0.0 for stage in STAGES)
    combination = Combination.parse(choice.combination)
    drawn = process.draw(choice.pair, combination, START_SECONDS + PATIENCE * seconds)
    if isinstance(drawn, str):
        raise _UnrepeatableError(drawn)
    note = _difference(row, drawn)
    most = max(len(drawn.keypoints_1), len(drawn.keypoints_2))
    every_k, every_m = _step(most, MOST_KEYPOINTS), _step(len(drawn.matches), MOST_MATCHES)
    numbers = {pair["pair"]: position for position, pair in enumerate(found.pairs())}
    return {
        "entry": found.name,
        "combination": choice.combination,
        "pair": numbers[choice.pair],
        "image_1": _image_key(found, row["image_1"]),
        "image_2": _image_key(found, row["image_2"]),
        "keypoints_1": packed_floats(drawn.keypoints_1[::every_k]),
        "keypoints_2": packed_floats(drawn.keypoints_2[::every_k]),
        "keypoints_every": every_k,
        "matches": packed_floats(drawn.matches[::every_m]),
        "inlier": packed_bytes(drawn.inliers[::every_m]),
        "right": None if drawn.right is None else packed_bytes(drawn.right[::every_m]),
        "judge": drawn.judge,
        "matches_every": every_m,
        "why": choice.why,
        "role": choice.role,
        "note": note,
        "figures": {name: row[name] for name in FIGURES if row.get(name) is not None},
    }


def _measured_row(found: ReportEntry, choice: Choice) -> Row:
    import polars as pl

    name = combination_name()
    chosen = found.rows.filter(name == choice.combination, pl.col("pair") == choice.pair)
    return chosen.row(0, named=True)


def _difference(row: Row, drawn: DrawnMatches) -> str | None:
    """How a repetition differs from the measurement, if only in matches or inliers.

    Raises
    ------
    _UnrepeatableError
        If the keypoints differ.
    """
    counts = drawn.counts()
    for name in ("keypoints_1", "keypoints_2"):
        if counts[name] != row[name]:
            raise _UnrepeatableError(
                f"{counts[name]:,} keypoints now, {row[name]:,} when measured: the images, "
                "the version of OpenCV or the machine differ, or the method is not repeatable"
            )
    differing = [name for name in ("matches", "inliers") if counts[name] != row[name]]
    if not differing:
        return None
    told = ", ".join(f"{row[name]} {name} when measured, {counts[name]} here" for name in differing)
    return f"not fully repeatable: {told}"


def _step(number: int, most: int) -> int:
    """The smallest k for which taking every k-th leaves at most `most`."""
    return max(1, -(-number // most))
