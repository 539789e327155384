"""Which matches of a picture are right."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from aerocues.datasets.catalog import open_dataset
from aerocues.evaluation.context import make_context
from aerocues.methods.presets import as_preset
from aerocues.report.right_matches import RightMatches


def test_matches_are_judged_by_the_homography_of_the_pair() -> None:
    dataset = open_dataset("synthetic")
    context = make_context(dataset, as_preset("default"), seed=0, timing="shared")
    pair = replace(dataset.pairs[0], homography=np.array([[1.0, 0, 5], [0, 1, 0], [0, 0, 1]]))
    first = np.array([[10, 10], [20, 20], [30, 30]], np.float32)
    shift = np.array([[5, 0], [7, 0], [9, 0]], np.float32)
    right, judge = RightMatches(context).judged(pair, first, first + shift)
    assert judge == "ground truth"
    assert right is not None
    assert right.tolist() == [True, True, False]
