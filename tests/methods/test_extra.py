"""Methods on request beside those of the thesis: how they are chosen and what they compute."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from aerocues.methods.arrays import Features, Keypoints
from aerocues.methods.making import make_descriptor, make_detector, make_matcher
from aerocues.methods.motion_statistics import GmsMatcher
from aerocues.methods.ratio import RatioMatcher
from aerocues.methods.registry import Methods
from aerocues.methods.selection import select
from tests.methods.pictures import shifted_pair


def features(descriptors: np.ndarray, xy: np.ndarray | None = None) -> Features:
    places = np.zeros((len(descriptors), 2)) if xy is None else xy
    return Features(Keypoints.from_xy(places), descriptors, (400, 300))


def test_they_are_combined_where_they_are_asked_for(methods: Methods) -> None:
    assert len(select(methods)) == 340
    names = [str(each) for each in select(methods, "SIFT-*-L2-BF,SIFT_COLMAP-SIFT-*,+extra")]
    assert {"SIFT-ROOTSIFT-L2-BF", "SIFT_COLMAP-SIFT-L2-RATIO", "SIFT_COLMAP-SIFT-L2-GMS"} <= {
        *names
    }
    named = [str(each) for each in select(methods, "GFTT-ROOTSIFT-*,ORB-ORB-HAM-RATIO")]
    assert named == ["ORB-ORB-HAM-RATIO", "GFTT-ROOTSIFT-L2-BF", "GFTT-ROOTSIFT-L2-FLANN"]
    chosen = select(methods, detectors="SIFT_COLMAP", descriptors="SIFT,ROOTSIFT")
    assert [str(each) for each in chosen if each.matcher == "BF"] == [
        "SIFT_COLMAP-SIFT-L2-BF",
        "SIFT_COLMAP-ROOTSIFT-L2-BF",
    ]
    assert not [each for each in select(methods, "*,+extra") if str(each).startswith("MSD-ROOT")]
    assert "SIFT_COLMAP-ORB-HAM-BF" not in map(str, select(methods, "*,+extra"))


def test_root_sift_is_the_root_of_the_share_of_the_whole(methods: Methods) -> None:
    image, _ = shifted_pair()
    keypoints = make_detector(methods, "SIFT")
    found = keypoints.read(keypoints.call(image))
    both = []
    for name in ("SIFT", "ROOTSIFT"):
        stage = make_descriptor(methods, name, "SIFT")
        both.append(stage.read(stage.call(image, stage.prepare(found, image))))
    plain, root = (each.descriptors.astype(float) for each in both)
    assert np.allclose(root**2 * plain.sum(axis=1, keepdims=True), plain, atol=1e-2)
    assert np.allclose((root**2).sum(axis=1), 1, atol=1e-5)
    assert root.dtype == float
    assert both[1].descriptors.dtype == np.float32


def test_colmaps_threshold_finds_more(methods: Methods) -> None:
    assert methods.detectors["SIFT_COLMAP"].parameters["contrastThreshold"] == 0.02
    image, _ = shifted_pair()
    weak = np.asarray(image * 0.15 + 100, np.uint8)
    counts = []
    for name in ("SIFT", "SIFT_COLMAP"):
        stage = make_detector(methods, name)
        counts.append(len(stage.read(stage.call(weak))))
    assert counts[1] > 1.3 * counts[0]


@pytest.mark.parametrize(("norm", "kind"), [("L2", cv2.NORM_L2), ("HAM", cv2.NORM_HAMMING)])
def test_ratio_agrees_with_two_nearest_neighbours_of_opencv(norm: str, kind: int) -> None:
    random = np.random.default_rng(0)
    first = random.integers(0, 256, (150, 16), dtype=np.uint8)
    second = first[random.permutation(150)[:120]] ^ random.integers(0, 5, (120, 16), dtype=np.uint8)
    if norm == "L2":
        first, second = first.astype(np.float32), second.astype(np.float32)
    matches = RatioMatcher(0.8).match(features(first), features(second), norm)

    def clear(one: np.ndarray, other: np.ndarray) -> set[tuple[int, int]]:
        pairs = cv2.BFMatcher(kind).knnMatch(one, other, k=2)
        return {(a.queryIdx, a.trainIdx) for a, b in pairs if a.distance < 0.8 * b.distance}

    back = {(j, i) for i, j in clear(second, first)}
    assert {tuple(pair) for pair in matches.indices.tolist()} == clear(first, second) & back
    assert len(matches) > 100
    one = RatioMatcher(0.8).match(features(first[:1]), features(first[:1]), norm)
    assert one.indices.tolist() == [[0, 0]]


def test_gms_keeps_matches_that_move_alike() -> None:
    random = np.random.default_rng(0)
    xy = random.uniform(20, 280, (1500, 2))
    descriptors = random.integers(0, 256, (1500, 32), dtype=np.uint8)
    moved = xy + np.array([15, 8])
    wrong = np.arange(1200, 1500)
    moved[wrong] = random.uniform(20, 280, (300, 2))
    found = GmsMatcher(with_rotation=True, with_scale=False, threshold_factor=6.0).match(
        features(descriptors, xy), features(descriptors, moved), "HAM"
    )
    kept = found.indices[:, 0]
    assert len(kept) > 900
    assert np.isin(kept, wrong).mean() < 0.05
    assert (found.distance == 0).all()


def test_they_are_made_by_name(methods: Methods) -> None:
    descriptors = np.random.default_rng(0).integers(0, 256, (40, 32), dtype=np.uint8)
    for name in ("RATIO", "GMS"):
        stage = make_matcher(methods, name, "HAM")
        both = features(descriptors), features(descriptors[::-1].copy())
        stage.read(stage.call(*both))
