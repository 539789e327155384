"""A model from features and matches of one combination."""

from __future__ import annotations

from typing import Any

from aerocues.pipeline.features import StageError
from aerocues.reconstruction.database import verified_inliers, write_database
from aerocues.reconstruction.diagnosis import Outcome, without_features, without_links
from aerocues.reconstruction.feature_size import features_scale
from aerocues.reconstruction.mapping import map_scene
from aerocues.reconstruction.matched_scene import MatchedScene, read_matched_scene
from aerocues.reconstruction.matching import SceneMatcher
from aerocues.reconstruction.one_model import (
    DATABASE,
    MAPPING,
    OPTIONAL_STAGE,
    Linked,
    ModelMaker,
)
from aerocues.reconstruction.precision import keypoint_error
from aerocues.reconstruction.refining import refine_scene, refinement_figures, warm_up_refinement
from aerocues.reconstruction.verification import agreeing, verify
from aerocues.results.metrics import Row

MATCHES = "matches.npz"


class CombinationModel(ModelMaker):
    """Detects, describes and matches by a combination, and has COLMAP verify and map."""

    def match_ahead(self) -> Row:
        """Leave features and matches for later: they depend on no camera.

        What fails here fails again when the model is made, which then says so.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        try:
            self._matched()
        except StageError as failure:
            return {"status": failure.status, "message": failure.message}
        return self.row

    def link(self) -> Linked | Outcome:
        matched = self._matched()
        if failure := without_features({n: len(k) for n, k in matched.keypoints.items()}):
            return failure
        agreed = self.timed(
            "verification", lambda: agreeing(matched, self.scene, self.combination, self.announce)
        )
        self.row["linked_pairs"] = len(agreed.pairs)
        sharper = self._refined(agreed)
        linked = self.timed("verification", lambda: self._verify(sharper))
        self.row.update(
            verified_pairs=len(linked.inliers),
            verified_matches=sum(linked.inliers.values(), start=0),
        )
        failure = without_links(
            self.row["pairs"],
            self.row["linked_pairs"],
            len(linked.inliers),
            chance=self.scene.protocol.chance is not None,
        )
        return failure or linked

    def map(self) -> list[Any]:
        database, protocol = self.folder / DATABASE, self.scene.protocol
        largest_error = None
        if protocol.error_limit is not None:
            error = keypoint_error(database)
            largest_error = protocol.error_limit.pixels(error)
            self.row.update(keypoint_error=error, error_limit=largest_error)
        return map_scene(
            database, self.scene.images, self.folder / MAPPING, protocol, largest_error
        )

    def _matched(self) -> MatchedScene:
        """Features and matches: those that are there already, or new ones."""
        file = self.folder / MATCHES
        key = self.scene.matching_key(self.combination)
        matched = read_matched_scene(file, key)
        if matched is None:
            matched = SceneMatcher(self.scene, self.combination, self.announce).match()
            matched.write(file, key)
        self.row.update(
            pairs=len(self.scene.dataset.pairs),
            matches=sum(len(each) for each in matched.pairs.values()),
            feature_seconds=matched.feature_seconds,
            matching_seconds=matched.matching_seconds,
        )
        return matched

    def _refined(self, matched: MatchedScene) -> MatchedScene:
        """The scene with sharper keypoints, where they are asked for."""
        refinement = self.scene.protocol.refinement
        if refinement is None:
            return matched
        warm_up_refinement(refinement)
        dataset = self.scene.dataset
        scale = features_scale(dataset.images[0], self.scene.protocol.features_width)
        sharper, found = self.timed(
            OPTIONAL_STAGE, lambda: refine_scene(dataset, matched, refinement, scale)
        )
        self.row.update(refinement_figures(found))
        return sharper

    def _verify(self, matched: MatchedScene) -> Linked:
        database = self.folder / DATABASE
        numbers = write_database(database, self.scene, matched)
        if not matched.pairs:
            return Linked({}, numbers)
        verify(database, matched.pairs, self.scene, self.combination)
        return Linked(verified_inliers(database, numbers), numbers)
