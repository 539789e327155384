"""COLMAP by its own defaults, to compare with: its SIFT, its matcher, and a refined camera."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from itertools import combinations
from pathlib import Path
from typing import Any

from aerocues.datasets.dataset import Dataset
from aerocues.reconstruction.calibration import CAMERA_MODEL, calibrations
from aerocues.reconstruction.colmap import major_minor, open_database, require
from aerocues.reconstruction.database import new_database, verified_inliers
from aerocues.reconstruction.diagnosis import Outcome, without_features, without_links
from aerocues.reconstruction.mapping import map_by_default
from aerocues.reconstruction.matched_scene import Names
from aerocues.reconstruction.one_model import DATABASE, MAPPING, Linked, ModelMaker
from aerocues.reconstruction.scene import CameraGroup, Scene
from aerocues.results.hashing import content_hash
from aerocues.results.metrics import Row
from aerocues.results.reconstruction_schema import BASELINE
from aerocues.results.whole_files import json_content, write_whole

MATCHED = "matched.json"
# Raised whenever the same images would give another model.
BASELINE_VERSION = 1
# COLMAP matches all pairs; of more images that takes longer than all of the rest.
MOST_IMAGES_EXHAUSTIVE = 50
OLDEST = (4, 0)


def baseline_problem() -> str | None:
    """Why this version of pycolmap cannot make the baseline; None where it can."""
    if major_minor() >= OLDEST:
        return None
    return f"COLMAP's default needs pycolmap {OLDEST[0]}.{OLDEST[1]} or newer"


def baseline_pairs(dataset: Dataset) -> tuple[str, list[Names]]:
    """Which pairs COLMAP matches: ``exhaustive``, or those of the others in large scenes."""
    if len(dataset.images) <= MOST_IMAGES_EXHAUSTIVE:
        return "exhaustive", list(combinations([image.name for image in dataset.images], 2))
    pairing = dict(dataset.settings).get("pairs", "own")
    return pairing, [(pair.image_1, pair.image_2) for pair in dataset.pairs]


def baseline_row_key(scene: Scene) -> str:
    """Names the model of COLMAP's default: settings of the others do not matter to it.

    The cameras of the scene must be those that were known before any calibration.
    """
    truth = [
        [image.name, image.truth.centre.tolist(), image.truth.rotation.tolist()]
        for image in scene.dataset.images
        if image.truth
    ]
    requirements = asdict(scene.protocol.requirements)
    return content_hash([_matched_key(scene), truth, requirements, asdict(scene.wanted)])


def _matched_key(scene: Scene) -> str:
    """Names features, matches and verified pairs."""
    return content_hash(
        [
            BASELINE_VERSION,
            str(BASELINE),
            baseline_pairs(scene.dataset)[1],
            [[image.name, scene.image_keys[image.name]] for image in scene.dataset.images],
            [[group.model, group.parameters, group.names] for group in scene.cameras],
            [scene.protocol.max_keypoints, scene.protocol.seed, scene.versions[1]],
        ]
    )


def baseline_facts(scene: Scene) -> Row:
    """What a row tells of COLMAP's default in place of what it tells of the others."""
    pairing, pairs = baseline_pairs(scene.dataset)
    sources = ", ".join(sorted({group.source for group in scene.cameras}))
    return {
        "pairs": len(pairs),
        "pairing": pairing,
        "preset": "colmap",
        "parameters": "{}",
        "intrinsics": f"refined ({sources})",
        "mapper": "incremental",
        "opencv_version": None,
    }


class BaselineModel(ModelMaker):
    """Everything by COLMAP's defaults, with one thread and a seed.

    Images, focal length to begin with and number of features are those of the other models.
    """

    def link(self) -> Linked | Outcome:
        """Extract, match and verify; what is there already under the same key is taken."""
        pairs = baseline_pairs(self.scene.dataset)[1]
        self.row["pairs"] = len(pairs)
        key = _matched_key(self.scene)
        times = _read_times(self.folder / MATCHED, key)
        if times is None:
            (self.folder / MATCHED).unlink(missing_ok=True)
            self._match(pairs)
            names = ("feature_seconds", "matching_seconds", "verification_seconds")
            times = {name: self.row[name] for name in names}
            write_whole({self.folder / MATCHED: json_content({"key": key, "seconds": times})})
        self.row.update(times)
        return self._linked()

    def map(self) -> list[Any]:
        return map_by_default(
            self.folder / DATABASE,
            self.scene.images,
            self.folder / MAPPING,
            self.scene.protocol.seed,
        )

    def figures(self, model: Any) -> Row:
        return {"calibration": calibrations(model, self.scene.cameras)}

    def _match(self, pairs: list[Names]) -> None:
        database = self.folder / DATABASE
        new_database(database, replace(self.scene, cameras=_refinable(self.scene.cameras)))
        self.timed("feature", lambda: _extract(database, self.scene))
        self.timed("matching", lambda: _match(database, pairs))
        self.timed("verification", lambda: _verify(database, self.scene.protocol.seed))

    def _linked(self) -> Linked | Outcome:
        database = self.folder / DATABASE
        numbers, keypoints, matches = _counts(database)
        inliers = verified_inliers(database, numbers)
        linked = sum(1 for count in matches if count)
        self.row.update(
            matches=sum(matches),
            linked_pairs=linked,
            verified_pairs=len(inliers),
            verified_matches=sum(inliers.values(), start=0),
        )
        failure = without_features(keypoints) or without_links(
            len(matches), linked, len(inliers), chance=False
        )
        return failure or Linked(inliers, numbers)


def _refinable(cameras: Sequence[CameraGroup]) -> tuple[CameraGroup, ...]:
    """Cameras of COLMAP's default model, with the focal length that is known to begin with."""
    found = []
    for group in cameras:
        if group.model == "PINHOLE":
            focal_length, _, *centre = group.parameters
            parameters = (focal_length, *centre, 0.0)
            found.append(replace(group, model=CAMERA_MODEL, parameters=parameters))
        else:
            found.append(group)
    return tuple(found)


def _read_times(file: Path, key: str) -> Row | None:
    try:
        stored = json.loads(file.read_text(encoding="utf-8"))
        return dict(stored["seconds"]) if stored["key"] == key else None
    except (OSError, ValueError, KeyError):
        return None


def _extract(database: Path, scene: Scene) -> None:
    import pycolmap

    options = require("FeatureExtractionOptions", "COLMAP's default")()
    options.type = pycolmap.FeatureExtractorType.SIFT  # others end the process without ONNX
    options.num_threads, options.use_gpu = 1, False
    if scene.protocol.max_keypoints:
        options.sift.max_num_features = scene.protocol.max_keypoints
    names = [image.name for image in scene.dataset.images]
    pycolmap.extract_features(
        database,
        scene.images,
        image_names=names,
        extraction_options=options,
        device=pycolmap.Device.cpu,
    )


def _match(database: Path, pairs: list[Names]) -> None:
    import pycolmap

    options = pycolmap.FeatureMatchingOptions()
    options.type = pycolmap.FeatureMatcherType.SIFT_BRUTEFORCE
    options.num_threads, options.use_gpu = 1, False
    options.skip_geometric_verification = True
    pairing = pycolmap.ImportedPairingOptions()
    listed = database.with_name("pairs.txt")
    pairing.match_list_path = str(listed)
    with _named_by_numbers(database) as numbers:
        lines = (f"{numbers[first]} {numbers[second]}\n" for first, second in pairs)
        listed.write_text("".join(lines), encoding="ascii")
        pycolmap.match_image_pairs(database, options, pairing, device=pycolmap.Device.cpu)
    listed.unlink()


@contextlib.contextmanager
def _named_by_numbers(file: Path) -> Iterator[dict[str, int]]:
    """Give images their numbers as names: COLMAP's list of pairs ends a name at a space."""
    names = _rename(file, {})
    yield {name: number for number, name in names.items()}
    _rename(file, names)


def _rename(file: Path, names: Mapping[int, str]) -> dict[int, str]:
    """Rename images, by default to their numbers; the names that they had, by number."""
    database = open_database(file)
    try:
        images = database.read_all_images()
        earlier = {int(image.image_id): str(image.name) for image in images}
        for image in images:
            image.name = names.get(image.image_id, str(image.image_id))
            database.update_image(image)
    finally:
        database.close()
    return earlier


def _verify(database: Path, seed: int) -> None:
    import pycolmap

    options = pycolmap.TwoViewGeometryOptions()
    options.ransac.random_seed = seed
    verifier = pycolmap.GeometricVerifierOptions()
    verifier.num_threads = 1
    pycolmap.set_random_seed(seed)
    pycolmap.geometric_verification(database, verifier, two_view_geometry_options=options)


def _counts(file: Path) -> tuple[dict[str, int], dict[str, int], list[int]]:
    """Numbers of the images, and how many keypoints each image and matches each pair has."""
    database = open_database(file)
    try:
        numbers = {str(image.name): int(image.image_id) for image in database.read_all_images()}
        keypoints = {
            name: int(database.num_keypoints_for_image(number)) for name, number in numbers.items()
        }
        matches = [int(count) for count in database.read_num_matches()[1]]
    finally:
        database.close()
    return numbers, keypoints, matches
