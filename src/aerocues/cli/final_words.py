"""The final of a recommendation in words: whose model is best, and COLMAP's default beside it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from aerocues.cli.console import plain_table
from aerocues.phrases import count, spoken_seconds
from aerocues.pipeline.block import MOST_IMAGES
from aerocues.results.combination_columns import name_in_row
from aerocues.results.reconstruction_schema import BASELINE
from aerocues.tuning.final import images_in_place, model_value

if TYPE_CHECKING:
    from rich.table import Table

    from aerocues.tuning.final import Final

CLOSE = 0.95
"""Share of the best value at which a model counts as equally good."""
MUCH_FASTER = 0.67
COLMAP_DEFAULT = "COLMAP's default"


def headline(final: Final, leader: str) -> str:
    """``Take X: 18 of 18 images in place, 2,362 points ...; COLMAP's default: 18, 1,9xx ...``.

    Without a model it is the leader of the race.
    """
    best, baseline = final.best, final.baseline
    if best is None:
        made = (
            f"only the model of {COLMAP_DEFAULT}" if list(final.rows) == [baseline] else "no model"
        )
        return f"Take {leader}, which leads the race: {made} was finished in time."
    if is_baseline(best):
        other = final.best_combination
        beside = f" The best combination, {name_in_row(other)}: {_short(other)}." if other else ""
        return f"Take {COLMAP_DEFAULT}: {_figures(best)}.{beside}"
    told = f"Take {name_in_row(best)}: {_figures(best)}"
    if baseline is not None:
        told += f"; {COLMAP_DEFAULT}: {_short(baseline)}"
    return f"{told}."


def notes(final: Final) -> list[str]:
    """What was built of which images, who came close, and what there was no time for."""
    part = "all images" if final.images == final.of else "a connected block of the flight"
    share = f"{part} ({final.images} of {final.of})"
    if final.images < min(MOST_IMAGES, final.of):
        share = f"{part} ({final.images} of {final.of}; the time is too short for more)"
    told = [f"no model of {share} was finished in time"]
    if final.rows:
        told = [
            f"{count(len(final.rows), 'model')} of {share} in {final.folder}; the best holds the "
            "most images, then placed share x sqrt(points in 3 images / error)"
            + (", less for more time" if final.objective.time_power else "")
        ]
    told += _close(final)
    if final.unfinished:
        told.append(
            f"no time for {', '.join(map(_name, final.unfinished))}; a larger --budget builds them"
        )
    return told


def _close(final: Final) -> list[str]:
    """Models that are as good as the best one, and much faster."""
    best = final.best
    if best is None:
        return []
    least = CLOSE * model_value(best, final.objective)
    close = [
        row
        for row in final.rows
        if row is not best
        and row["status"] == best["status"]
        and images_in_place(row) == images_in_place(best)
        and model_value(row, final.objective) >= least
    ]
    return [
        f"{_name(name_in_row(row))} is as good within {1 - CLOSE:.0%}: {_short(row)}"
        for row in close
    ]


def is_baseline(row: Mapping[str, Any]) -> bool:
    """Whether a row is that of COLMAP's default."""
    return name_in_row(row) == str(BASELINE)


def _name(name: str) -> str:
    return COLMAP_DEFAULT if name == str(BASELINE) else name


def _figures(row: Mapping[str, Any]) -> str:
    place = "in the model" if row["placed_images"] is None else "in place"
    told = (
        f"{images_in_place(row)} of {row['images']} images {place}, "
        f"{row['points_3d'] or 0:,} points seen by {row['mean_track_length'] or 0:.1f} images, "
        f"{row['reprojection_error'] or 0:.2f} px"
    )
    if row["position_rmse"] is not None:
        told += f", cameras {row['position_rmse']:.2g} m off"
    return f"{told}, in {_seconds(row)}"


def _short(row: Mapping[str, Any]) -> str:
    if not row["registered_images"]:
        return f"{row['status']}"
    told = f"{images_in_place(row)} images, {row['points_3d']:,} points, "
    return f"{told}{row['reprojection_error']:.2f} px, {_seconds(row)}"


def _seconds(row: Mapping[str, Any]) -> str:
    seconds = row["reconstruction_seconds"]
    return "unknown time" if seconds is None else spoken_seconds(seconds)


def final_table(final: Final, ranked: Sequence[str]) -> Table:
    """The models, the best first, with the place that each had in the race."""
    place = {
        features: rank for rank, features in reversed(list(enumerate(map(_features, ranked), 1)))
    }
    headings = ("in\nplace", "in 3\nimages", "track\nlength", "error\npx", "CPU\ns", "race")
    table = plain_table("model", "status", *headings, numbers=len(headings))
    for row in final.rows:
        name = name_in_row(row)
        table.add_row(
            _name(name),
            row["status"],
            f"{images_in_place(row)}/{row['images']}",
            _number(row["points_in_3_images"], ",.0f"),
            _number(row["mean_track_length"], ".2f"),
            _number(row["reprojection_error"], ".2f"),
            _number(row["reconstruction_seconds"], ",.1f"),
            _number(place.get(_features(name)), "d"),
        )
    return table


def _features(name: str) -> str:
    """Detector and descriptor of a combination in text form."""
    return "-".join(name.split("-")[:2])


def _number(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)
