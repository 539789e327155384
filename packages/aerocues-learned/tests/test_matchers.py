"""Matches agree with those of torch."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from aerocues_learned.matchers import LighterGlue, LightGlue, LightGlueMatcher
from aerocues_learned.weights import lightglue_weights
from numpy.typing import NDArray

from aerocues import Features, Keypoints
from aerocues.errors import MethodUnavailableError


def made(kind: type[LightGlueMatcher], **changed: Any) -> LightGlueMatcher:
    return kind(**{**kind.parameters, **changed})  # type: ignore[attr-defined]


def golden_features(name: str, number: int, golden: dict[str, Any], own: Features) -> Features:
    """Torch's keypoints with our descriptors of the same keypoints."""
    height, width = golden[f"image_{number}"].shape[:2]
    return Features(own.keypoints, own.descriptors, image_size=(width, height))


def pairs(indices: NDArray[Any]) -> set[tuple[int, int]]:
    return {(int(first), int(second)) for first, second in indices}


def agreement(
    matcher: LightGlueMatcher, name: str, golden: dict[str, Any], own: list[Features]
) -> float:
    """Share of torch's matches that are ours, and the other way round: of both in either."""
    sized = [golden_features(name, i, golden, each) for i, each in enumerate(own, 1)]
    found = pairs(matcher.match(sized[0], sized[1], "L2").indices)
    numbers = [nearest(golden[f"{name}_xy_{i}"], each) for i, each in enumerate(own, 1)]
    theirs = golden[f"{matcher.name.lower()}_matches"]
    expected = pairs(np.stack([numbers[0][theirs[:, 0]], numbers[1][theirs[:, 1]]], axis=1))
    assert len(expected) > 50
    return len(found & expected) / len(found | expected)


def nearest(xy: NDArray[Any], features: Features) -> NDArray[np.intp]:
    """Our keypoint for each of torch's."""
    away = np.linalg.norm(xy[:, None] - features.keypoints.xy[None], axis=2)
    return np.asarray(away.argmin(axis=1))


def test_lighterglue_matches_as_torch(
    golden: dict[str, Any], features: dict[str, list[Features]]
) -> None:
    assert agreement(made(LighterGlue), "xfeat", golden, features["xfeat"]) > 0.98


def test_lightglue_matches_as_torch(
    golden: dict[str, Any], features: dict[str, list[Features]]
) -> None:
    try:
        lightglue_weights()
    except MethodUnavailableError as error:
        pytest.skip(str(error))
    name = "aliked-n16rot"
    assert agreement(made(LightGlue), name, golden, features[name]) > 0.98


def test_single_keypoints_can_be_matched() -> None:
    unit = np.eye(64, dtype=np.float32)
    one, two = (
        Features(Keypoints.from_xy(np.full((n, 2), 9.0)), unit[:n], image_size=(64, 48))
        for n in (1, 2)
    )
    matcher = made(LighterGlue, threshold=0.0)
    assert len(matcher.match(one, two, "L2")) <= 1
    assert len(matcher.match(two, one, "L2")) <= 1


def test_features_without_the_size_of_their_image_are_refused() -> None:
    bare = Features(Keypoints.from_xy(np.zeros((3, 2))), np.zeros((3, 64), np.float32))
    with pytest.raises(ValueError, match="LIGHTERGLUE"):
        made(LighterGlue).match(bare, bare, "L2")
