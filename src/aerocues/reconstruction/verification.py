"""Links between pairs of images: the chance test, then COLMAP's verification."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from aerocues.methods.combination import Combination
from aerocues.pipeline.clock import Clock
from aerocues.pipeline.feature_source import Announce, silent
from aerocues.pipeline.pair_stages import stage_call
from aerocues.pipeline.verification import Verdict, Verifier
from aerocues.reconstruction.feature_size import features_scale
from aerocues.reconstruction.matched_scene import MatchedScene, Names
from aerocues.reconstruction.scene import Scene


def agreeing(
    matched: MatchedScene,
    scene: Scene,
    combination: Combination,
    announce: Announce = silent,
) -> MatchedScene:
    """The pairs whose matches beat chance, with those matches that agree with their geometry.

    COLMAP samples again, with its own models: of matches that are mostly right it needs few
    samples, and hardly any wrong one becomes a point. Without a chance test, all pairs with a
    geometry; and all pairs with enough matches where nobody needs to know which agree.
    """
    least = scene.protocol.verification.minimum_matches
    enough = {names: each for names, each in matched.pairs.items() if len(each) >= least}
    if scene.protocol.chance is None and scene.protocol.refinement is None:
        return replace(matched, pairs=enough)
    measurement = scene.measurement()
    scale = features_scale(scene.dataset.images[0], scene.protocol.features_width)
    measurement = measurement.with_threshold(measurement.threshold(combination) * scale)
    verifier = Verifier(measurement, "epipolar", Clock(measurement.seed), count_all=False)
    pairs = {}
    for number, (names, matches) in enumerate(enough.items(), start=1):
        call = stage_call("verify", combination, " and ".join(names))
        announce(replace(call, number=number, total=len(enough)))
        verdict = _verdict(verifier, matched, names)
        if verdict.passed:
            pairs[names] = matches.chosen(verdict.model.inliers)
    return replace(matched, pairs=pairs)


def _verdict(verifier: Verifier, matched: MatchedScene, names: Names) -> Verdict:
    first, second = matched.points(names)
    order = np.argsort(matched.pairs[names].distance, kind="stable")
    return verifier.verify(first, second, order)


def verify(database: Path, pairs: Iterable[Names], scene: Scene, combination: Combination) -> None:
    """Verify all pairs in the database, by essential or fundamental matrix and homography."""
    import pycolmap

    options = pycolmap.TwoViewGeometryOptions()
    protocol, threshold = scene.protocol, scene.threshold(combination)
    options.ransac.max_num_trials = protocol.mapping.verification_trials
    if threshold is not None:
        options.ransac.max_error = threshold
    if hasattr(options.ransac, "random_seed"):
        options.ransac.random_seed = protocol.seed
    pycolmap.set_random_seed(protocol.seed)
    if hasattr(pycolmap, "geometric_verification"):
        verifier = pycolmap.GeometricVerifierOptions()
        verifier.num_threads = 1
        pycolmap.geometric_verification(database, verifier, two_view_geometry_options=options)
        return
    listed = database.with_name("pairs.txt")
    listed.write_text("".join(f"{first} {second}\n" for first, second in pairs), encoding="utf-8")
    pycolmap.verify_matches(database, listed, options)
    listed.unlink()
