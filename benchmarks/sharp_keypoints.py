"""What sharper keypoints give to models of flights whose truth is known.

    python benchmarks/sharp_keypoints.py FLIGHT... [-o FOLDER] [--combinations GLOBS]

A flight is what `aerocues reconstruct` takes, such as simulated:DIR. "Before" is keypoints as
OpenCV gives them and COLMAP's own limit of 4 px; "after" keypoints without bias, refined, and the
limit that follows their error. Prints for both the root mean square error of the cameras, the
median error of the surface, the points that are right to 0.15 m and the CPU seconds from images to
the model. What is there already in the folder is not made again.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pycolmap

from aerocues.datasets.dataset import Dataset
from aerocues.methods.presets import Preset, preset_named
from aerocues.reconstruction.colmap import quiet
from aerocues.reconstruction.models import Models
from aerocues.reconstruction.opening import open_scene
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.protocol import ReconstructionProtocol
from aerocues.reconstruction.reconstruct import reconstruct_scene
from aerocues.reconstruction.truth import centres_of, locate, surface_errors, true_positions
from aerocues.results.combination_columns import name_in_row

COMBINATIONS = (
    "SIFT-SIFT-L2-EXACT,AKAZE-AKAZE-HAM-EXACT,ORB-ORB-HAM-EXACT,ORB-BEBLID-HAM-EXACT,"
    "BRISK-BRISK-HAM-EXACT,STAR-BRISK-HAM-EXACT,GFTT-BRISK-HAM-EXACT,AKAZE-SIFT-L2-EXACT"
)
KEYPOINTS = 4000
RIGHT = 0.15
AS_OPENCV = Preset("as_opencv", "keypoints as OpenCV gives them", chance_test=True, unbiased=False)
HEAD = (
    *("flight", "combination", "images", "camera RMSE (m)", "surface (m)", "points right"),
    *("CPU s", "accepted", "shift (px)"),
)


def made(dataset: Dataset, combinations: str, folder: Path) -> dict[str, Models]:
    """Models as they were before, and as they are now."""
    now = ReconstructionProtocol(max_keypoints=KEYPOINTS)
    plain = replace(now, refinement=None, error_limit=None)
    ways = {"before": (AS_OPENCV, plain), "after": (preset_named("default"), now)}
    return {
        name: reconstruct_scene(
            dataset,
            combinations,
            folder / name,
            ReconstructionOptions(preset=preset, protocol=protocol, workers=1),
            None,
        )
        for name, (preset, protocol) in ways.items()
    }


def right_points(models: Models, combination: str, dataset: Dataset) -> int | None:
    """How many points of a model are right to `RIGHT` metres."""
    folder = models.path(combination) / "sparse" / "0"
    truth = true_positions(dataset)
    if not folder.is_dir() or truth is None or truth.source != "poses":
        return None
    model = pycolmap.Reconstruction(str(folder))
    located = locate(centres_of(model), truth, ReconstructionProtocol().requirements)
    if located is None:
        return None
    views = {image.name: image.truth for image in dataset.images if image.truth}
    return int((surface_errors(model, views, located.frame) <= RIGHT).sum())


def compared(dataset: Dataset, combinations: str, folder: Path) -> Iterator[list[str]]:
    """A row a combination: before and after."""
    models = made(dataset, combinations, folder)
    tables = [
        {name_in_row(row): row for row in each.table().to_dicts()} for each in models.values()
    ]
    for name, after in tables[1].items():
        both = [tables[0][name], after]
        for row, each in zip(both, models.values(), strict=True):
            row["right"] = right_points(each, name, dataset)
        yield [
            name,
            *(_both(both, *column) for column in COLUMNS),
            _number(after["refined_share"], ".2f"),
            _number(after["refinement_shift"], ".2f"),
        ]


COLUMNS = (
    ("registered_images", "d"),
    ("position_rmse", ".3f"),
    ("surface_error", ".3f"),
    ("right", ",d"),
    ("reconstruction_seconds", ".1f"),
)


def _both(rows: list[dict[str, Any]], name: str, form: str) -> str:
    return " > ".join(_number(row[name], form) for row in rows)


def _number(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("flights", nargs="+")
    parser.add_argument("-o", "--output", type=Path, default=Path("sharp-models"))
    parser.add_argument("--combinations", default=COMBINATIONS)
    arguments = parser.parse_args()
    quiet()
    print("| " + " | ".join(HEAD) + " |")
    print("| " + " | ".join("---" for _ in HEAD) + " |", flush=True)
    for flight in arguments.flights:
        dataset = open_scene(flight)
        name = Path(flight.partition(":")[2] or flight).name
        for cells in compared(dataset, arguments.combinations, arguments.output / name):
            print("| " + " | ".join([name, *cells]) + " |", flush=True)


if __name__ == "__main__":
    main()
