"""A user's pair matcher is measured, scored, drawn and limited like other combinations."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import aerocues
from aerocues.datasets.dataset import Dataset, Image, Pixels
from aerocues.datasets.decoded import DecodedSource
from aerocues.errors import MethodFailedError
from aerocues.evaluation.context import make_context
from aerocues.methods import plugins
from aerocues.methods.combination import Combination
from aerocues.methods.pair_matching import PointMatches
from aerocues.methods.presets import preset_named
from aerocues.methods.strongest import ALL_KEYPOINTS, KeypointLimit
from aerocues.pipeline.clock import NO_TIME
from aerocues.pipeline.features import ImageFeatures
from aerocues.pipeline.whole_images import matched_pair
from aerocues.report.drawn_matches import Drawer, DrawnMatches
from tests.evaluation.inline import InlineEngine

FOLLOW = "FOLLOW-NONE-NONE-FOLLOW"


@pytest.fixture
def following(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plugins, "_REGISTERED", {})
    aerocues.register("pair_matcher", "FOLLOW", "tests.methods.following:Follow")


@pytest.mark.slow
@pytest.mark.usefixtures("following")
def test_it_is_measured_scored_and_drawn(views: Dataset, tmp_path: Path) -> None:
    results = aerocues.run(
        views, "FOLLOW,ORB-*-FOLLOW", tmp_path, timing="shared", engine=InlineEngine()
    )
    rows = results.table().filter(detector="FOLLOW").to_dicts()
    assert [row["status"] for row in rows] == ["ok"] * 3
    for row in rows:
        assert (row["descriptor"], row["norm"], row["matcher"]) == ("NONE", "NONE", "FOLLOW")
        assert row["keypoints_1"] == row["keypoints_2"] == row["matches"] > 300
        assert row["inliers"] > 0.9 * row["matches"]
        assert row["ref_precision@3"] > 0.9
        assert (row["detect_seconds_1"], row["describe_seconds_2"], row["descriptor_bytes"]) == (
            *(0, 0),
            0,
        )
        assert row["match_seconds"] > 0
        assert json.loads(row["parameters"])["matcher"][2] == {"corners": 2000}
    for row in results.table().filter(detector="ORB").to_dicts():
        assert (row["status"], row["descriptor"], row["describe_seconds_1"]) == ("ok", "NONE", 0)
        assert row["keypoints_1"] > row["matches"] > 100
        assert row["detect_seconds_1"] > 0
        assert row["ref_precision@3"] > 0.95
    assert FOLLOW in aerocues.score(results).frame()["combination"].to_list()
    context = make_context(views, preset_named("default"))
    drawn = Drawer(context).draw(0, Combination.parse(FOLLOW))
    assert isinstance(drawn, DrawnMatches)
    assert drawn.counts() == {name: rows[0][name] for name in drawn.counts()}


@pytest.mark.usefixtures("following")
def test_two_images_are_matched_in_one_call(views: Dataset) -> None:
    first, second = views.images[:2]
    matched = aerocues.match(first, second, "FOLLOW", max_keypoints=50)
    assert len(matched.matches) == len(matched.features_1) == 50
    assert matched.beats_chance
    assert matched.features_2.image_size == second.read().bgr.shape[1::-1]
    with pytest.raises(MethodFailedError, match="both"):
        aerocues.features(first, "FOLLOW")


def image(valid: np.ndarray | None) -> ImageFeatures:
    pixels = Pixels(np.zeros((10, 20, 3), np.uint8), valid)
    source = Image("1", DecodedSource(pixels))
    from aerocues.methods.arrays import Keypoints

    return ImageFeatures(source, pixels, Keypoints.from_xy(np.empty((0, 2))), NO_TIME)


def test_positions_that_no_object_has_and_the_weakest_are_left_out() -> None:
    points = np.array([[1, 1], [2, 2], [3, 3], [15, 5]], np.float32)
    found = PointMatches(points, points + 1, np.array([0.1, 0.4, 0.3, 0.2], np.float32))
    left = np.zeros((10, 20), bool)
    left[:, :10] = True
    whole = matched_pair(found, (image(None), image(left)), ALL_KEYPOINTS, 0)
    assert whole.features[0].keypoints.xy[:, 0].tolist() == [1, 2, 3]
    assert whole.features[1].keypoints.xy[:, 0].tolist() == [2, 3, 4]
    best = matched_pair(found, (image(None), image(left)), KeypointLimit(2), 0)
    assert best.features[0].keypoints.xy[:, 0].tolist() == [2, 3]
    assert best.matches.indices.tolist() == [[0, 0], [1, 1]]
    assert best.matches.distance.tolist() == [np.float32(-0.4), np.float32(-0.3)]
    assert best.features[1].image_size == (20, 10)
