"""The clouds of the most interesting models, packed for the page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import StoreError
from aerocues.report.arrays import packed_bytes, packed_floats, packed_scaled
from aerocues.report.cloud_frames import in_one_frame
from aerocues.report.entry import ReportEntry
from aerocues.results.clouds import Cloud
from aerocues.results.combination_columns import name_in_row
from aerocues.results.model_quality import model_order
from aerocues.results.reconstruction_schema import BASELINE

MOST_CLOUDS = 10
MOST_POINTS = 6000
SEED = 0
# Strays lie outside the box of these quantiles (this share and 1 - this share), enlarged by its own
# size on each side.
STRAYS = 0.005
LONGEST_TRACK = 255
OK = "ok"
AMONG_THE_BEST = "among the best"
Row = dict[str, Any]


@dataclass
class Clouds:
    """Clouds of the payload, the most important first, and notes."""

    clouds: list[dict[str, Any]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def clouds_of(found: ReportEntry) -> Clouds:
    """The clouds of an entry to show; empty if there are no models.

    Parameters
    ----------
    found : ReportEntry
    """
    result = Clouds()
    chosen = _chosen(found, result)
    placed = in_one_frame([cloud for _, _, cloud in chosen])
    for (name, why, _), cloud in zip(chosen, placed, strict=True):
        result.clouds.append(
            {"entry": found.name, "combination": name, "why": why, **_packed(cloud)}
        )
    return result


def _chosen(found: ReportEntry, result: Clouds) -> list[tuple[str, str, Cloud]]:
    """Combination, reasons and cloud of each; unreadable clouds are noted."""
    opened: dict[str, Cloud | None] = {}

    def cloud_of(row: Row) -> Cloud | None:
        name = row["name"]
        if name not in opened:
            try:
                opened[name] = found.results.cloud(row["row_key"])
            except StoreError as error:
                opened[name] = None
                result.notes.append(f"{found.name}: no cloud of {name}: {error}")
        return opened[name]

    rows = [row for row in _rows(found) if row["row_key"] and row["registered_images"]]
    reasons: dict[str, list[str]] = {}
    for why, candidates in _reasons(rows):
        # If the file of a cloud is missing, the next candidate is taken.
        row = next((each for each in candidates if cloud_of(each) is not None), None)
        if row is not None:
            reasons.setdefault(row["name"], []).append(why)
    for row in sorted(rows, key=lambda each: (each["status"] != OK, each["rank"])):
        if len(reasons) < MOST_CLOUDS and cloud_of(row) is not None:
            reasons.setdefault(row["name"], [AMONG_THE_BEST if row["status"] == OK else "failed"])
    shown = ((name, "; ".join(why), opened[name]) for name, why in reasons.items())
    return [(name, why, cloud) for name, why, cloud in shown if cloud is not None]


def _reasons(rows: Sequence[Row]) -> list[tuple[str, Sequence[Row]]]:
    """Reasons to show a model, the most important first, each with its candidates in order."""
    good, misplaced, incomplete = (
        [row for row in rows if row["status"] == status]
        for status in (OK, "misplaced", "incomplete")
    )
    placed = [row for row in good if row["position_rmse"] is not None]
    return [
        ("reference of the distances", [row for row in rows if row["reference"] == row["name"]]),
        ("best by CUES", sorted(good, key=lambda row: row["rank"])),
        ("best model", sorted(good, key=model_order)),
        ("COLMAP's default", [row for row in rows if row["name"] == str(BASELINE)]),
        ("largest position errors", sorted(misplaced, key=_by_error, reverse=True)),
        ("most points", sorted(good, key=lambda row: -(row["points_3d"] or 0))),
        ("smallest position errors", sorted(placed, key=_by_error)),
        ("fewest images", sorted(incomplete, key=_by_size, reverse=True)),
    ]


def _rows(found: ReportEntry) -> list[Row]:
    """Reconstructions with the name of the combination and its rank by CUES."""
    ranks = dict(found.ranking.frame("combination").select("combination", "rank").iter_rows())
    rows = found.models.to_dicts()
    for row in rows:
        row["name"] = name_in_row(row)
        row["rank"] = ranks.get(row["name"], len(rows) + len(ranks))
    return sorted(rows, key=lambda row: str(row["name"]))


def _by_size(row: Row) -> tuple[int, int]:
    return -row["registered_images"], -(row["points_3d"] or 0)


def _by_error(row: Row) -> float:
    return float(row["position_rmse"] or 0.0)


def _packed(cloud: Cloud) -> dict[str, Any]:
    """A seeded sample of the points, and all cameras."""
    near = _without_strays(cloud)
    kept = near
    if len(near) > MOST_POINTS:
        generator = np.random.default_rng(SEED)
        kept = np.sort(generator.choice(near, MOST_POINTS, replace=False))
    points = cloud.points[kept]
    return {
        "unit": cloud.unit,
        "all_points": len(cloud.points),
        "strays": len(cloud.points) - len(near),
        "points": _scaled(points),
        "colours": packed_bytes(cloud.colours[kept]),
        "errors": _scaled(cloud.errors[kept]),
        "track_lengths": packed_bytes(np.minimum(cloud.track_lengths[kept], LONGEST_TRACK)),
        "distances": _scaled(cloud.distances[kept]),
        "centres": packed_floats(cloud.centres),
        "rotations": packed_floats(cloud.rotations),
        "positions": packed_floats(cloud.positions),
        "names": [str(name) for name in cloud.names],
        "view": cloud.view.tolist(),
    }


def _without_strays(cloud: Cloud) -> NDArray[np.int64]:
    """Indices of the points without the strays."""
    if not len(cloud.points):
        return np.arange(0)
    low, high = np.quantile(cloud.points, (STRAYS, 1 - STRAYS), axis=0)
    room = np.max(high - low)
    inside = (cloud.points >= low - room) & (cloud.points <= high + room)
    return np.flatnonzero(inside.all(axis=1))


def _scaled(values: NDArray[np.float32]) -> dict[str, str | float] | None:
    """Values packed between their minimum and maximum; None if there are no values."""
    known = values[np.isfinite(values)]
    if not len(known):
        return None
    return packed_scaled(values, float(known.min()), float(known.max()))
