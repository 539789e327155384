"""Features, matches and verified links of a scene, without a model: what other tools go on from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from aerocues.reconstruction.combination_model import CombinationModel
from aerocues.reconstruction.database import verified_matches
from aerocues.reconstruction.diagnosis import Outcome
from aerocues.reconstruction.matched_scene import MatchedScene, PairMatches
from aerocues.reconstruction.one_model import DATABASE, Linked

LINKED, VERIFIED = "linked.npz", "verified.npz"


class LinkMaker(CombinationModel):
    """Stops at verified pairs, and keeps the keypoints and matches that COLMAP got.

    ``linked.npz`` has the matches that agree with the geometry of a pair that beats chance,
    ``verified.npz`` those of them that COLMAP verified; both with the key of the combination's
    matches.
    """

    def _reconstruct(self) -> Outcome:
        linked = self.link()
        return linked if isinstance(linked, Outcome) else Outcome("ok")

    def _verify(self, matched: MatchedScene) -> Linked:
        linked = super()._verify(matched)
        found = verified_matches(self.folder / DATABASE, linked.numbers)
        verified = {}
        for first, second in matched.pairs:
            indices = found.get((first, second))
            if indices is None and (second, first) in found:
                indices = found[second, first][:, ::-1]
            if indices is not None:
                none = np.zeros(len(indices), np.float32)
                verified[first, second] = PairMatches(indices.astype(np.int32), none)
        key = self.scene.matching_key(self.combination)
        matched.write(self.folder / LINKED, key)
        replace(matched, pairs=verified).write(self.folder / VERIFIED, key)
        return linked
