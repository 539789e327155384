from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from aerocues.methods.arrays import Keypoints
from aerocues.methods.registry import opencv_methods
from aerocues.methods.strongest import KeypointLimit, limited


def keypoints(responses: list[float], xy: NDArray[np.float64] | None = None) -> Keypoints:
    count = len(responses)
    found = Keypoints.from_xy(np.arange(2.0 * count).reshape(count, 2) if xy is None else xy)
    return Keypoints(**{**vars(found), "response": np.array(responses, np.float32)})


def test_detectors_that_limit_themselves_are_told_to() -> None:
    methods = limited(opencv_methods(), 4000)
    assert methods.detectors["ORB"].parameters["nfeatures"] == 4000
    assert methods.detectors["GFTT_H"].parameters["maxCorners"] == 4000
    assert methods.detectors["AKAZE"] == opencv_methods().detectors["AKAZE"]
    assert limited(opencv_methods(), 0) == opencv_methods()
    raised = limited(methods, 9000)
    assert raised.detectors["ORB"].parameters["nfeatures"] == 4000
    # To choose from each part of the image, all must be there to choose from.
    assert KeypointLimit(4000, spread=True).limited(opencv_methods()) == opencv_methods()


def test_the_strongest_keypoints_keep_their_order() -> None:
    kept = KeypointLimit(3).keep(keypoints([3, 1, 5, 2, 4]), seed=0)
    np.testing.assert_array_equal(kept.response, [3, 5, 4])
    assert len(KeypointLimit().keep(keypoints([3, 1]), seed=0)) == 2
    assert len(KeypointLimit(5).keep(keypoints([3, 1]), seed=0)) == 2


def test_equal_responses_favour_no_part_of_the_image() -> None:
    limit = KeypointLimit(100)
    kept = limit.keep(keypoints([0.0] * 1000), seed=0)
    assert 300 < kept.xy[:, 0].mean() / 2 < 700
    again = limit.keep(keypoints([0.0] * 1000), seed=0)
    np.testing.assert_array_equal(kept.xy, again.xy)


def test_spread_keypoints_are_the_strongest_of_each_part() -> None:
    # Nine in ten keypoints, and the strongest, lie in one corner.
    generator = np.random.default_rng(0)
    corner, rest = generator.uniform(0, 20, (900, 2)), generator.uniform(0, 200, (100, 2))
    responses = [*generator.uniform(10, 20, 900), *generator.uniform(1, 2, 100)]
    found = keypoints(responses, np.vstack([corner, rest]))
    assert (KeypointLimit(100).keep(found, 0).xy <= 20).all()
    spread = KeypointLimit(100, spread=True).keep(found, 0)
    assert len(spread) == 100
    assert (spread.xy > 20).any(axis=1).sum() > 80
    # What is kept of a crowded part is its best.
    kept = spread.response[spread.response >= 10]
    assert kept.min() > np.median(found.response[:900])


@given(st.integers(1, 60), st.integers(1, 60), st.integers(0, 2**32 - 1), st.booleans())
def test_a_limit_keeps_so_many_each_once_and_in_order(
    count: int, limit: int, seed: int, spread: bool
) -> None:
    generator = np.random.default_rng(seed)
    xy = generator.integers(0, 8, (count, 2)).astype(np.float64)
    found = keypoints(list(np.arange(count, dtype=np.float64)), xy)
    kept = KeypointLimit(limit, spread).keep(found, seed)
    assert len(kept) == min(count, limit)
    assert (np.diff(kept.response) > 0).all()
