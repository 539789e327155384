from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from aerocues.methods.arrays import Matches
from aerocues.pipeline.tracks import tracks_of


def matches(*rows: Sequence[float]) -> Matches:
    """Matches from rows of keypoint, keypoint, distance."""
    table = np.array(rows, np.float64).reshape(-1, 3)
    return Matches(table[:, :2].astype(np.int32), table[:, 2].astype(np.float32))


def test_matches_join_keypoints_of_several_images() -> None:
    pairs = {(0, 1): matches((0, 1, 5)), (1, 2): matches((1, 0, 7)), (0, 2): matches((1, 1, 9))}
    tracks = tracks_of([2, 3, 2], pairs)
    # Keypoints: 0 and 1 of image 0; 2, 3 and 4 of image 1; 5 and 6 of image 2.
    assert tracks.first.tolist() == [0, 2, 5, 7]
    assert tracks.image.tolist() == [0, 0, 1, 1, 1, 2, 2]
    assert tracks.track.tolist() == [0, 1, -1, 0, -1, 0, 1]
    assert tracks.degree.tolist() == [1, 1, 0, 2, 0, 1, 1]


def test_of_two_keypoints_of_an_image_the_closer_one_joins() -> None:
    # The far match would put both keypoints of image 0 into one track.
    pairs = {(0, 1): matches((0, 0, 9)), (1, 2): matches((0, 0, 1)), (0, 2): matches((1, 0, 3))}
    tracks = tracks_of([2, 1, 1], pairs)
    assert tracks.track[[1, 2, 3]].tolist() == [1, 1, 1]
    assert tracks.track[0] == 0


def test_nothing_matched_makes_no_track() -> None:
    assert tracks_of([2, 1], {}).track.tolist() == [-1, -1, -1]
    assert tracks_of([], {}).track.tolist() == []


@st.composite
def pairs_of_images(draw: st.DrawFn) -> tuple[list[int], dict[tuple[int, int], Matches]]:
    counts = draw(st.lists(st.integers(1, 4), min_size=2, max_size=4))
    pairs = {}
    for first in range(len(counts)):
        for second in range(first + 1, len(counts)):
            ends = st.tuples(
                st.integers(0, counts[first] - 1),
                st.integers(0, counts[second] - 1),
                st.integers(0, 5),
            )
            pairs[first, second] = matches(*draw(st.lists(ends, max_size=4)))
    return counts, pairs


@given(pairs_of_images())
def test_no_track_holds_two_keypoints_of_an_image(
    drawn: tuple[list[int], dict[tuple[int, int], Matches]],
) -> None:
    counts, pairs = drawn
    tracks = tracks_of(counts, pairs)
    members = np.flatnonzero(tracks.track >= 0)
    seen = list(zip(tracks.track[members].tolist(), tracks.image[members].tolist(), strict=True))
    assert len(set(seen)) == len(seen)
    matched = {
        int(tracks.first[image] + keypoint)
        for pair, each in pairs.items()
        for row in each.indices
        for image, keypoint in zip(pair, row.tolist(), strict=True)
    }
    assert set(members.tolist()) == matched
