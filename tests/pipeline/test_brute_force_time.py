"""Brute force timed on a part: the same rows, and times that tell the whole."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from aerocues.datasets.dataset import Dataset
from aerocues.evaluation.run import run
from aerocues.methods.arrays import Features, Keypoints
from aerocues.methods.making import make_matcher
from aerocues.methods.registry import opencv_methods
from aerocues.pipeline import brute_force_time
from aerocues.pipeline.brute_force_time import SampledBruteForce
from aerocues.pipeline.clock import Clock
from tests.evaluation.inline import InlineEngine
from tests.evaluation.scenes import assert_same_rows, rows_of

COMBINATIONS = "ORB-ORB-HAM-BF,SIFT-SIFT-L2-BF,ORB-BRIEF-HAM-FLANN"


@pytest.mark.slow
def test_estimated_times_leave_everything_else_as_it_is(
    views: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(brute_force_time, "FEWEST_TIMED", 2000)
    engine = InlineEngine()
    shared = run(views, COMBINATIONS, tmp_path / "s", engine=engine)
    estimated = run(views, COMBINATIONS, tmp_path / "e", engine=engine, timing="estimated")
    assert_same_rows(rows_of(estimated.table()), rows_of(shared.table()))
    assert set(estimated.table()["timing"]) == {"estimated"}
    assert estimated.table()["match_seconds"].min() > 0  # type: ignore[operator]


@pytest.mark.slow
def test_estimated_times_do_not_stand_for_measured_ones(views: Dataset, tmp_path: Path) -> None:
    engine, folder = InlineEngine(), tmp_path / "r"
    run(views, "ORB-ORB-HAM-BF", folder, engine=engine, timing="estimated")
    again = run(views, "ORB-ORB-HAM-BF", folder, engine=engine, timing="shared")
    assert set(again.table()["timing"]) == {"shared"}
    back = run(views, "ORB-ORB-HAM-BF", folder, engine=engine, timing="estimated")
    assert set(back.table()["timing"]) == {"shared"}


def test_all_is_timed_where_it_is_little_and_a_part_is_scaled(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    cv2.setNumThreads(1)
    random = np.random.default_rng(0)
    first, second = (
        Features(
            Keypoints.from_xy(random.random((count, 2))),
            random.integers(0, 256, (count, 32)).astype(np.uint8),
        )
        for count in (400, 300)
    )
    stage = make_matcher(opencv_methods(), "BF", "HAM")
    whole = stage.read(stage.call(first, second))
    asked: list[int] = []
    monkeypatch.setattr(type(stage), "call", _counting(type(stage).call, asked))
    sampled = SampledBruteForce(stage, "HAM", Clock())
    monkeypatch.setattr(brute_force_time, "FEWEST_TIMED", 400 * 300)
    assert sampled.match(first, second)[0].indices.tolist() == whole.indices.tolist()
    monkeypatch.setattr(brute_force_time, "FEWEST_TIMED", 400 * 30)
    matches, time = sampled.match(first, second)
    assert matches.indices.tolist() == whole.indices.tolist()
    assert matches.distance.tobytes() == whole.distance.tobytes()
    assert asked == [300, 30]
    assert time.cpu > 0
    monkeypatch.setattr(brute_force_time, "TIMED_SHARE", 0.5)
    sampled.match(first, second)
    monkeypatch.setattr(brute_force_time, "MOST_TIMED", 400 * 40)
    sampled.match(first, second)
    assert asked[2:] == [150, 40]


def _counting(call: object, asked: list[int]) -> object:
    def counted(self: object, first: Features, second: Features) -> object:
        asked.append(len(second))
        return call(self, first, second)  # type: ignore[operator]

    return counted
