"""Features of all images and matches of all pairs under one combination."""

from __future__ import annotations

import shutil
from collections import OrderedDict
from dataclasses import dataclass, replace

import numpy as np

from aerocues.methods.arrays import Features, Matches
from aerocues.methods.combination import Combination
from aerocues.pipeline.clock import Clock
from aerocues.pipeline.feature_folder import FeatureFolder
from aerocues.pipeline.feature_source import Announce, FeatureSource, TimedFeatures
from aerocues.pipeline.features import ImageFeatures, StageError, unless_failed
from aerocues.pipeline.pair_stages import PairStages
from aerocues.processes.call import StageCall
from aerocues.reconstruction.feature_size import at_full_size, smaller
from aerocues.reconstruction.matched_scene import MatchedScene, PairMatches
from aerocues.reconstruction.merging import matched_keypoints, merged
from aerocues.reconstruction.scene import Scene

HELD_IN_MEMORY = 64


@dataclass(frozen=True)
class Matching:
    """Work of a process: features and matches of a combination, for its model later."""

    combination: Combination


@dataclass(frozen=True)
class Links:
    """Work of a process: features, matches and verified links of a combination."""

    combination: Combination


class SceneMatcher:
    """Detects, describes and matches a scene under one combination.

    What a measurement of the same images, or another combination with the same detector and
    descriptor, left in the folder of features is taken from there, with the time that it took.
    """

    def __init__(self, scene: Scene, combination: Combination, announce: Announce) -> None:
        protocol = scene.measurement()
        clock = Clock(protocol.seed)
        self._scene = scene
        self._combination = combination
        self._tell, self._place = announce, (0, 0)
        self._folder = FeatureFolder(scene.features, scene.methods, protocol, scene.machine)
        self._features = FeatureSource(
            scene.methods, protocol, clock, folder=self._folder, announce=self._announce
        )
        self._stages = PairStages(
            scene.methods, protocol, scene.dataset.geometry, clock, self._announce
        )
        self._held: OrderedDict[str, Features] = OrderedDict()

    def _announce(self, call: StageCall) -> None:
        """Announce a call, and which image or pair of how many it is about."""
        number, total = self._place
        self._tell(replace(call, number=number, total=total))

    def match(self) -> MatchedScene:
        """Features and matches; StageError where a method fails."""
        if self._combination.of_pairs:
            return self._match_images()
        keypoints = {}
        seconds = 0.0
        images = self._scene.dataset.images
        for number, image in enumerate(images, start=1):
            self._place = number, len(images)
            found = self._timed_features(image.name)
            width = self._scene.protocol.features_width
            keypoints[image.name] = at_full_size(found.features.keypoints, image, width)
            seconds += found.seconds
            if not np.isfinite(keypoints[image.name].xy).all():
                raise StageError(
                    "error",
                    f"{self._combination.descriptor} describing {image.name} returned positions "
                    "that are not finite",
                )
        pairs, matching_seconds = self._match_pairs()
        return MatchedScene(keypoints, pairs, seconds, matching_seconds)

    def _match_images(self) -> MatchedScene:
        """What a pair matcher finds or guides; positions of several pairs become keypoints."""
        found = {}
        seconds = 0.0
        width, chosen = self._scene.protocol.features_width, self._scene.dataset.pairs
        for number, pair in enumerate(chosen, start=1):
            self._place = number, len(chosen)
            one, other = (self._image(name) for name in (pair.image_1, pair.image_2))
            images = f"{pair.image_1} and {pair.image_2}"
            matched, time = self._stages.match_images(self._combination, (one, other), images)
            found[pair.image_1, pair.image_2] = matched
            seconds += time.cpu
            self._features.trim()
        images_by_name = {image.name: image for image in self._scene.dataset.images}
        arrange = matched_keypoints if self._combination.guided else merged
        keypoints, pairs = arrange(images_by_name, found)
        full = {
            name: at_full_size(each, images_by_name[name], width)
            for name, each in keypoints.items()
        }
        return MatchedScene(full, pairs, 0.0, seconds)

    def _image(self, name: str) -> ImageFeatures:
        image = smaller(self._scene.dataset.image(name), self._scene.protocol.features_width)
        return unless_failed(self._features.detected(image, self._combination.detector))

    def _timed_features(self, name: str) -> TimedFeatures:
        image = smaller(self._scene.dataset.image(name), self._scene.protocol.features_width)
        found = self._features.features(image, self._combination)
        self._features.trim()
        if self._folder.problem:
            # Each image would be described anew for each of its pairs.
            raise StageError("error", self._folder.problem)
        return found

    def _match_pairs(self) -> tuple[dict[tuple[str, str], PairMatches], float]:
        pairs = {}
        seconds = 0.0
        chosen = self._scene.dataset.pairs
        for number, pair in enumerate(chosen, start=1):
            self._place = number, len(chosen)
            features = self._held_features(pair.image_1), self._held_features(pair.image_2)
            matches = Matches()
            if all(len(each) for each in features):
                images = f"{pair.image_1} and {pair.image_2}"
                matches, time = self._stages.match(self._combination, features, images)
                seconds += time.cpu
            pairs[pair.image_1, pair.image_2] = PairMatches(matches.indices, matches.distance)
        return pairs, seconds

    def _held_features(self, name: str) -> Features:
        """Features from memory, where those used last are kept."""
        if name not in self._held:
            self._held[name] = self._timed_features(name).features
        self._held.move_to_end(name)
        if len(self._held) > HELD_IN_MEMORY:
            self._held.popitem(last=False)
        return self._held[name]


def remove_features(scene: Scene, combination: Combination | None = None) -> None:
    """Make room: descriptors are many times larger than what is made of them.

    A folder of features that the user named stays as it is.
    """
    if scene.features.parent != scene.folder:
        return
    place = scene.features
    if combination is not None:
        place /= f"{combination.detector}-{combination.descriptor}"
    shutil.rmtree(place, ignore_errors=True)
