"""A model from features and matches of one combination."""

from __future__ import annotations

from typing import Any

from aerocues.reconstruction.database import verified_inliers, write_database
from aerocues.reconstruction.diagnosis import Outcome, without_features, without_links
from aerocues.reconstruction.mapping import map_scene
from aerocues.reconstruction.matched_scene import MatchedScene, read_matched_scene
from aerocues.reconstruction.matching import SceneMatcher
from aerocues.reconstruction.one_model import DATABASE, MAPPING, Linked, ModelMaker
from aerocues.reconstruction.verification import linked_pairs, verify

MATCHES = "matches.npz"


class CombinationModel(ModelMaker):
    """Detects, describes and matches by a combination, and has COLMAP verify and map."""

    def link(self) -> Linked | Outcome:
        matched = self._matched()
        if failure := without_features({n: len(k) for n, k in matched.keypoints.items()}):
            return failure
        linked = self.timed("verification", lambda: self._verify(matched))
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
        return map_scene(
            self.folder / DATABASE,
            self.scene.images,
            self.folder / MAPPING,
            self.scene.protocol,
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

    def _verify(self, matched: MatchedScene) -> Linked:
        linked = linked_pairs(matched, self.scene, self.combination)
        self.row["linked_pairs"] = len(linked)
        database = self.folder / DATABASE
        numbers = write_database(database, self.scene, matched, linked)
        if not linked:
            return Linked({}, numbers)
        verify(database, linked, self.scene, self.combination)
        return Linked(verified_inliers(database, numbers), numbers)
