"""Figures of matches and keypoints, by hand."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pixels
from aerocues.pipeline import point_figures
from aerocues.pipeline.correspondence import PlaneCorrespondence
from aerocues.pipeline.point_figures import PointFigures, coverage

BLANK = Pixels(np.zeros((50, 100, 3), np.uint8))
SAME = PlaneCorrespondence(np.eye(3), BLANK, BLANK)


def points(*xy: tuple[float, float]) -> NDArray[np.float32]:
    return np.array(xy, np.float32).reshape(-1, 2)


def test_shares_are_of_matches_and_of_keypoints() -> None:
    first = points((10, 10), (20, 10), (30, 10), (40, 10), (50, 10))
    second = points((10, 11), (22.5, 10), (36, 10), (44.5, 10))
    errors = SAME.errors(first[:4], second)
    np.testing.assert_allclose(errors, [1, 2.5, 6, 4.5])
    found = PointFigures("ref").of(errors, (first, second), SAME)
    assert found == {
        "ref_precision@1": 1 / 4,
        "ref_precision@3": 2 / 4,
        "ref_precision@5": 3 / 4,
        "ref_matching_score@1": 1 / 5,
        "ref_matching_score@3": 2 / 5,
        "ref_matching_score@5": 3 / 5,
        "ref_repeatability": 2 / 4,
    }


def test_without_matches_no_precision_is_told() -> None:
    first = points((10, 10))
    found = PointFigures("gt").of(np.zeros(0), (first, first), SAME)
    assert found["gt_matching_score@3"] == 0
    assert "gt_precision@3" not in found
    assert found["gt_repeatability"] == 1


def test_without_keypoints_nothing_is_told() -> None:
    none = points()
    assert PointFigures("ref").of(np.zeros(0), (none, none), SAME) == {"ref_repeatability": None}


def test_the_repeatability_of_the_same_keypoints_is_worked_out_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = list[object]()

    def ask(*of: object) -> float:
        asked.append(of)
        return 0.5

    monkeypatch.setattr(point_figures, "repeatability", ask)
    figures, first = PointFigures("ref"), points((10, 10))
    for keypoints in ((first, first), (first, first), (first, first + 1)):
        figures.of(np.zeros(0), keypoints, SAME)
    assert len(asked) == 2
    figures.begin_pair()
    figures.of(np.zeros(0), (first, first), SAME)
    assert len(asked) == 3


@pytest.mark.parametrize(
    ("right", "cells"),
    [
        ((), 0),
        (((3, 3), (3.4, 3.4)), 1),
        (((-0.5, -0.5), (159.4, 79.4)), 2),
        # Cells of 10 x 5 pixels, the first of which ends half a pixel before pixel 10.
        (((9.4, 0), (9.6, 0), (0, 4.4), (0, 4.6)), 3),
    ],
)
def test_coverage_counts_the_cells_of_a_grid(
    right: tuple[tuple[float, float], ...], cells: int
) -> None:
    assert coverage(points(*right), (80, 160, 3)) == cells / 256
