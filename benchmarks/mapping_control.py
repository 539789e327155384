"""What the path from matches to a model changes, with COLMAP's own SIFT features and matches.

    python benchmarks/mapping_control.py FLIGHT [FLIGHT ...] [--features 4000] [--folder FOLDER]

Makes the model of COLMAP's default, then others from its features and its matches before
verification, with one setting changed at a time. If nothing is lost on the way, the second row
equals the first. Prints a row a setting: images, points, points seen by 3 images or more, track
length, reprojection error, position error, and CPU seconds of verification and of mapping. A flight
is what `aerocues reconstruct` takes, such as flight:DIR or simulated:DIR.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from aerocues.methods.arrays import Keypoints
from aerocues.methods.combination import Combination
from aerocues.reconstruction.baseline import BaselineModel
from aerocues.reconstruction.calibration import told_calibration
from aerocues.reconstruction.colmap import open_database, quiet
from aerocues.reconstruction.database import write_database
from aerocues.reconstruction.images import HALF_PIXEL
from aerocues.reconstruction.mapping import map_by_default, map_scene
from aerocues.reconstruction.matched_scene import MatchedScene, PairMatches
from aerocues.reconstruction.one_model import DATABASE
from aerocues.reconstruction.opening import open_scene
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.protocol import Intrinsics, ReconstructionProtocol
from aerocues.reconstruction.quality import model_figures
from aerocues.reconstruction.reconstruction_progress import ReconstructionProgress
from aerocues.reconstruction.scene import Scene
from aerocues.reconstruction.scene_making import scene_of, with_cameras
from aerocues.reconstruction.truth import centres_of, compare_with_truth, locate, true_positions
from aerocues.reconstruction.verification import agreeing, verify
from aerocues.results.reconstruction_schema import BASELINE

SIFT = Combination("SIFT", "SIFT", "L2", "BF")  # names the inlier threshold
WIDTH = 1000
MOST_TRIALS = 10_000


@dataclass(frozen=True)
class Setting:
    """What differs from the defaults of `aerocues reconstruct` with a refined camera."""

    name: str
    pairs: str = "exhaustive"
    intrinsics: Intrinsics = "refine"
    chance: bool = True
    trials: int = 1000
    default_mapper: bool = False


SETTINGS = (
    Setting("all as COLMAP", chance=False, trials=MOST_TRIALS, default_mapper=True),
    Setting("ours, camera refined"),
    Setting("- without chance test", chance=False),
    Setting("- 10,000 trials", trials=MOST_TRIALS),
    Setting("- COLMAP's mapping settings", default_mapper=True),
    Setting("- GPS neighbours", pairs="gps"),
    Setting("ours, camera fixed", intrinsics="fixed"),
    Setting("- GPS neighbours", pairs="gps", intrinsics="fixed"),
)


def scene_with(flight: str, folder: Path, features: int, setting: Setting) -> Scene:
    dataset = open_scene(flight, pairs=setting.pairs, max_width=WIDTH)
    protocol = ReconstructionProtocol(max_keypoints=features, intrinsics=setting.intrinsics)
    options = ReconstructionOptions(protocol=protocol)
    (folder / "images").mkdir(parents=True, exist_ok=True)
    scene = scene_of(dataset, folder, options)
    mapping = replace(protocol.mapping, verification_trials=setting.trials)
    chance = protocol.chance if setting.chance else None
    scene = replace(scene, protocol=replace(protocol, mapping=mapping, chance=chance))
    return with_cameras(scene, options.limits(), ReconstructionProgress(None))


def matched_by_colmap(scene: Scene, file: Path) -> MatchedScene:
    """Features and matches of COLMAP's default; a pair that it did not match has none."""
    database = open_database(file)
    numbers = {str(image.name): image.image_id for image in database.read_all_images()}
    keypoints = {}
    for name, number in numbers.items():
        xy = np.asarray(database.read_keypoints(number))[:, :2] - HALF_PIXEL
        ones, zeros = np.ones(len(xy), np.float32), np.zeros(len(xy), np.int32)
        keypoints[name] = Keypoints(xy.astype(np.float32), ones, ones, ones, zeros, zeros)
    pairs = {}
    for pair in scene.dataset.pairs:
        found = database.read_matches(numbers[pair.image_1], numbers[pair.image_2])
        indices = np.asarray(found, np.int32).reshape(-1, 2)
        pairs[pair.image_1, pair.image_2] = PairMatches(
            indices, np.arange(len(indices), dtype=np.float32)
        )
    database.close()
    return MatchedScene(keypoints, pairs, 0.0, 0.0)


def timed(call: Callable[[], Any]) -> tuple[Any, float]:
    begun = time.process_time()
    return call(), time.process_time() - begun


def made(scene: Scene, setting: Setting, source: Path) -> tuple[list[Any], list[float]]:
    """Models with one setting, and CPU seconds of verification and of mapping."""
    matched = matched_by_colmap(scene, source)
    database = scene.folder / "control.db"

    def verified() -> None:
        agreed = agreeing(matched, scene, SIFT)
        write_database(database, scene, agreed)
        verify(database, agreed.pairs, scene, SIFT)

    def mapped() -> list[Any]:
        folder = scene.folder / "mapping"
        if setting.default_mapper:
            return map_by_default(database, scene.images, folder, scene.protocol.seed)
        return map_scene(database, scene.images, folder, scene.protocol)

    _, verification = timed(verified)
    models, mapping = timed(mapped)
    return models, [verification, mapping]


def told(scene: Scene, models: list[Any], seconds: list[float]) -> str:
    if not models:
        return "no model"
    located = locate(
        centres_of(models[0]), true_positions(scene.dataset), scene.protocol.requirements
    )
    row = {**model_figures(models[0]), **compare_with_truth(models[0], scene.dataset, located)}
    images = f"{row['registered_images']} of {len(scene.dataset.images)}"
    return (
        f"{images:>9} {row['points_3d']:7,} {row['points_in_3_images']:7,} "
        f"{row['mean_track_length']:6.2f} {row['reprojection_error']:6.3f} "
        f"{row.get('position_rmse', float('nan')):7.2f} {row['focal_length']:7.1f} "
        + " ".join(f"{each:6.1f}" for each in seconds)
    )


def compare(flight: str, folder: Path, features: int) -> None:
    import pycolmap

    scene = scene_with(flight, folder, features, SETTINGS[0])
    row = BaselineModel(scene, BASELINE, lambda _: None).make()
    place = scene.place(BASELINE)
    alone = pycolmap.Reconstruction(str(place / "sparse" / "0"))
    heading = "images", "points", "in 3", "track", "px", "m", "focal", "verify", "map"
    print(f"{flight:28}" + "{:>9} {:>7} {:>7} {:>6} {:>6} {:>7} {:>7} {:>6} {:>6}".format(*heading))
    seconds = [row["verification_seconds"], row["mapping_seconds"]]
    print(f"{'COLMAP alone':28}{told(scene, [alone], seconds)}", flush=True)
    print(told_calibration(scene.cameras, row["calibration"]), flush=True)
    located = all(image.gps is not None for image in scene.dataset.images)
    for setting in SETTINGS:
        if setting.pairs == "gps" and not located:
            continue
        scene = scene_with(flight, folder, features, setting)
        print(
            f"{setting.name:28}{told(scene, *made(scene, setting, place / DATABASE))}", flush=True
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("flights", nargs="*")
    parser.add_argument("--features", type=int, default=4000)
    parser.add_argument("--folder", type=Path)
    given = parser.parse_args()
    quiet()
    with tempfile.TemporaryDirectory() as temporary:
        for number, flight in enumerate(given.flights):
            compare(flight, (given.folder or Path(temporary)) / str(number), given.features)


if __name__ == "__main__":
    main()
