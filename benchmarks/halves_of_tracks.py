"""How well the models of two random halves of the tracks agree: an error without ground truth.

    python benchmarks/halves_of_tracks.py FLIGHT [-o FOLDER] [--combinations GLOBS]

The flight's images must have GPS positions, which give the metres. Models are made of refined
keypoints and of those as they were found. Of each, the verified matches are parted by their tracks
into two halves that share no keypoint, and each half makes a model. Prints the root mean square
distance of the cameras of the two.
"""

from __future__ import annotations

import argparse
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Dataset
from aerocues.methods.arrays import Matches
from aerocues.pipeline.tracks import Tracks, tracks_of
from aerocues.reconstruction.alignment import robust_similarity, root_mean_square
from aerocues.reconstruction.colmap import image_pair, open_database, quiet
from aerocues.reconstruction.mapping import map_scene
from aerocues.reconstruction.models import Models
from aerocues.reconstruction.opening import open_scene
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.protocol import ReconstructionProtocol
from aerocues.reconstruction.reconstruct import reconstruct_scene
from aerocues.reconstruction.truth import centres_of, true_positions
from aerocues.results.combination_columns import name_in_row

COMBINATIONS = "SIFT-SIFT-L2-EXACT,AKAZE-AKAZE-HAM-EXACT,ORB-BEBLID-HAM-EXACT,STAR-BRISK-HAM-EXACT"
KEYPOINTS = 4000
SEEDS = 3


def tracks_in(database: Path) -> tuple[Tracks, dict[int, int]]:
    """Tracks of the verified matches, and the position of each of COLMAP's images among them."""
    opened = open_database(database)
    numbers = sorted(int(image.image_id) for image in opened.read_all_images())
    position = {number: place for place, number in enumerate(numbers)}
    counts = [len(opened.read_keypoints(number)) for number in numbers]
    pairs = {}
    for pair_id, geometry in zip(*opened.read_two_view_geometries(), strict=True):
        first, second = (position[number] for number in image_pair(pair_id))
        rows = np.asarray(geometry.inlier_matches, np.int32).reshape(-1, 2)
        pairs[first, second] = Matches(rows, np.zeros(len(rows), np.float32))
    opened.close()
    return tracks_of(counts, pairs), position


def halved(database: Path, seed: int) -> Iterator[Path]:
    """Two databases: one with the verified matches of a half of the tracks, one with the rest."""
    tracks, position = tracks_in(database)
    half = np.random.default_rng(seed).integers(0, 2, len(tracks.track))[tracks.track]
    for which in (0, 1):
        part = database.with_name(f"half{which}.db")
        for old in part.parent.glob(f"{part.name}*"):
            old.unlink()
        shutil.copyfile(database, part)
        opened = open_database(part)
        for pair_id, geometry in zip(*opened.read_two_view_geometries(), strict=True):
            pair = image_pair(pair_id)
            rows = np.asarray(geometry.inlier_matches).reshape(-1, 2)
            sides = [half[tracks.first[position[n]] + rows[:, i]] for i, n in enumerate(pair)]
            geometry.inlier_matches = rows[(sides[0] == which) & (sides[1] == which)]
            opened.update_two_view_geometry(*pair, geometry)
        opened.close()
        yield part


def centres(database: Path, images: Path, how: Any, limit: float | None) -> dict[str, Any]:
    """Camera centres of the largest model of a database, by name."""
    found = map_scene(database, images, database.with_suffix(".models"), how, limit)
    return centres_of(found[0]) if found else {}


def apart(first: dict[str, Any], second: dict[str, Any], dataset: Dataset) -> float | None:
    """Root mean square distance of two models' cameras in metres, when laid onto each other."""
    truth = true_positions(dataset)
    shared = sorted(set(first) & set(second))
    if truth is None or len(shared) < len(dataset.images) * 0.8:
        return None
    tolerance = truth.tolerance(ReconstructionProtocol().requirements)
    places = np.array([truth.by_name[name] for name in shared])
    one, other = (np.array([each[name] for name in shared]) for each in (first, second))
    to_metres = robust_similarity(one, places, tolerance)
    if to_metres is None:
        return None
    metres: NDArray[np.float64] = to_metres.apply(one)
    onto = robust_similarity(other, metres, tolerance)
    if onto is None:
        return None
    return float(root_mean_square(np.linalg.norm(onto.apply(other) - metres, axis=1)))


def disagreement(models: Models, row: dict[str, Any], dataset: Dataset, how: Any) -> float | None:
    """The median over some partings of how far the models of two halves are apart."""
    database, images = models.path(name_in_row(row)) / "database.db", models.folder / "images"
    found = []
    for seed in range(SEEDS):
        first, second = (
            centres(part, images, how, row["error_limit"]) for part in halved(database, seed)
        )
        found.append(apart(first, second, dataset))
    known = [each for each in found if each is not None]
    return float(np.median(known)) if known else None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("flight")
    parser.add_argument("-o", "--output", type=Path, default=Path("halves"))
    parser.add_argument("--combinations", default=COMBINATIONS)
    arguments = parser.parse_args()
    quiet()
    dataset = open_scene(arguments.flight)
    now = ReconstructionProtocol(max_keypoints=KEYPOINTS)
    ways = {"before": replace(now, refinement=None, error_limit=None), "after": now}
    print("| combination | keypoints | images | points | error (px) | halves apart (m) |")
    print("| --- | --- | --- | --- | --- | --- |", flush=True)
    for name, how in ways.items():
        models = reconstruct_scene(
            dataset,
            arguments.combinations,
            arguments.output / name,
            ReconstructionOptions(protocol=how, workers=1),
            None,
        )
        for row in models.table().to_dicts():
            metres = disagreement(models, row, dataset, how)
            cells = [name_in_row(row), name, row["registered_images"], row["points_3d"]]
            cells += [
                f"{row['reprojection_error']:.2f}",
                "-" if metres is None else f"{metres:.3f}",
            ]
            print("| " + " | ".join(map(str, cells)) + " |", flush=True)


if __name__ == "__main__":
    main()
