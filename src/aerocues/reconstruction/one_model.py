"""Makes and evaluates the model of one combination, in the folder of that combination."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable
from typing import Any, TypeVar

from aerocues.methods.combination import Combination
from aerocues.pipeline.feature_source import Announce
from aerocues.pipeline.features import StageError
from aerocues.pipeline.pair_stages import stage_call
from aerocues.reconstruction.colmap import registered
from aerocues.reconstruction.database import verified_inliers, write_database
from aerocues.reconstruction.diagnosis import (
    Outcome,
    Placement,
    judged,
    without_features,
    without_links,
    without_model,
)
from aerocues.reconstruction.exports import MODEL, PLY, TEXT, UNDISTORTED, export_model, undistort
from aerocues.reconstruction.mapping import map_scene
from aerocues.reconstruction.matched_scene import MatchedScene, Names, read_matched_scene
from aerocues.reconstruction.matching import SceneMatcher
from aerocues.reconstruction.picture import picture_of
from aerocues.reconstruction.quality import cloud_of, model_figures
from aerocues.reconstruction.scene import Scene
from aerocues.reconstruction.truth import (
    compare_with_truth,
    position_errors,
    to_true_frame,
    true_positions,
)
from aerocues.reconstruction.verification import linked_pairs, verify
from aerocues.results.metrics import Row
from aerocues.results.whole_files import write_whole

Result = TypeVar("Result")
MATCHES = "matches.npz"
DATABASE = "database.db"
CLOUD = "cloud.npz"
PICTURE = "picture.png"
OUTCOME = "outcome.json"
MAPPING = "mapping"


class ModelMaker:
    """Makes the model of one combination.

    Parameters
    ----------
    scene : Scene
    combination : Combination
    announce : callable
        Called with each stage before it starts.
    """

    def __init__(self, scene: Scene, combination: Combination, announce: Announce) -> None:
        self._scene = scene
        self._combination = combination
        self._announce = announce
        self._folder = scene.place(combination)
        self._row: Row = {}
        self._stage = "matching"

    def make(self) -> Row:
        """The row of the reconstruction with its status; unfinished parts are unknown."""
        self._folder.mkdir(parents=True, exist_ok=True)
        self._remove_earlier()
        self._row.update(
            images=len(self._scene.dataset.images), pairs=len(self._scene.dataset.pairs)
        )
        try:
            outcome = self._reconstruct()
        except StageError as failure:
            outcome = Outcome(failure.status, failure.message)
        except (RuntimeError, ValueError, KeyError, IndexError) as error:  # COLMAP's errors
            text = " ".join(str(error).split())
            outcome = Outcome("error", f"{self._stage}: {type(error).__name__}: {text}")
        times = [self._row.get(f"{stage}_seconds") for stage in _STAGES]
        if None not in times:
            self._row["reconstruction_seconds"] = sum(times)
        return {**self._row, "status": outcome.status, "message": outcome.message}

    def _remove_earlier(self) -> None:
        """Remove files made under other settings, except matches, which have their own key.

        The outcome is removed first, so that it never refers to removed files.
        """
        (self._folder / OUTCOME).unlink(missing_ok=True)
        for file in (CLOUD, PICTURE, PLY):
            (self._folder / file).unlink(missing_ok=True)
        for folder in (MODEL, TEXT, UNDISTORTED, MAPPING):
            shutil.rmtree(self._folder / folder, ignore_errors=True)
        for left_over in self._folder.glob("*.tmp"):
            left_over.unlink()

    def _reconstruct(self) -> Outcome:
        matched = self._matched()
        if failure := without_features({n: len(k) for n, k in matched.keypoints.items()}):
            return failure
        inliers, numbers = self._timed("verification", lambda: self._verify(matched))
        counts = (self._row["pairs"], self._row["linked_pairs"], len(inliers))
        self._row.update(
            verified_pairs=len(inliers), verified_matches=sum(inliers.values(), start=0)
        )
        chance = self._scene.protocol.chance is not None
        if failure := without_links(*counts, chance=chance):
            return failure
        models = self._timed(
            "mapping",
            lambda: map_scene(
                self._folder / DATABASE,
                self._scene.images,
                self._folder / MAPPING,
                self._scene.protocol,
            ),
        )
        self._row["components"] = len(models)
        if not models:
            return without_model(self._folder / DATABASE, inliers, numbers)
        return self._judge(models[0], inliers)

    def _matched(self) -> MatchedScene:
        """Features and matches: stored ones if they are valid, else new ones."""
        file = self._folder / MATCHES
        key = self._scene.matching_key(self._combination)
        matched = read_matched_scene(file, key)
        if matched is None:
            matched = SceneMatcher(self._scene, self._combination, self._announce).match()
            matched.write(file, key)
        self._row.update(
            matches=sum(len(each) for each in matched.pairs.values()),
            feature_seconds=matched.feature_seconds,
            matching_seconds=matched.matching_seconds,
        )
        return matched

    def _timed(self, stage: str, call: Callable[[], Result]) -> Result:
        self._stage = stage
        images = f"{len(self._scene.dataset.images)} images"
        self._announce(stage_call(stage, self._combination, images))
        begun = time.process_time()
        found = call()
        self._row[f"{stage}_seconds"] = time.process_time() - begun
        return found

    def _verify(self, matched: MatchedScene) -> tuple[dict[Names, int], dict[str, int]]:
        linked = linked_pairs(matched, self._scene, self._combination)
        self._row["linked_pairs"] = len(linked)
        database = self._folder / DATABASE
        numbers = write_database(database, self._scene, matched, linked)
        if not linked:
            return {}, numbers
        verify(database, linked, self._scene, self._combination)
        return verified_inliers(database, numbers), numbers

    def _judge(self, model: Any, inliers: dict[Names, int]) -> Outcome:
        """Evaluate the largest model and write its files."""
        scene = self._scene
        self._announce(stage_call("judging", self._combination, "its model"))
        if scene.wanted.colours:
            model.extract_colors_for_all_images(str(scene.images))
        requirements = scene.protocol.requirements
        truth = true_positions(scene.dataset)
        frame = to_true_frame(model, truth, requirements)
        self._row.update(model_figures(model))
        self._row.update(compare_with_truth(model, scene.dataset, truth, frame, requirements))
        placement = None
        if truth is not None and frame is not None:
            errors = position_errors(model, truth, frame)
            placement = Placement(errors, truth.tolerance(requirements), truth.source)
        outcome = judged(
            [image.name for image in scene.dataset.images],
            [str(image.name) for image in registered(model)],
            inliers,
            placement,
            requirements,
        )
        if truth is not None and frame is None:
            unknown = "its position errors are unknown: the cameras lie on a line"
            outcome = Outcome(outcome.status, "; ".join(filter(None, (outcome.message, unknown))))
        self._stage = "writing the model"
        export_model(model, self._folder)
        if scene.wanted.undistorted:
            undistort(self._folder, scene.images)
        cloud = cloud_of(model, scene.dataset, truth, frame)
        write_whole(
            {
                self._folder / CLOUD: cloud.content(),
                self._folder / PICTURE: picture_of(cloud, self._title(outcome)),
            }
        )
        return outcome

    def _title(self, outcome: Outcome) -> str:
        row = self._row
        return (
            f"{self._combination}: {row['registered_images']} of {row['images']} images, "
            f"{row['points_3d']:,} points, {row['reprojection_error']:.2f} px ({outcome.status})"
        )


_STAGES = ("feature", "matching", "verification", "mapping")
