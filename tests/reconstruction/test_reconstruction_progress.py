"""The progress of a reconstruction."""

from __future__ import annotations

import math

import pytest

from aerocues.methods.combination import Combination
from aerocues.processes.call import StageCall
from aerocues.progress import Activity, Event
from aerocues.reconstruction.reconstruction_progress import (
    ReconstructionProgress,
    share_of_model,
    summary,
)
from aerocues.reconstruction.remaining_time import RemainingTime
from aerocues.results.reconstruction_schema import BASELINE

METHODS = {"detector": "ORB", "descriptor": "ORB", "norm": "HAM", "matcher": "BF"}
MADE = {
    "registered_images": 12,
    "images": 18,
    "points_3d": 1323,
    "reprojection_error": 0.967,
    "position_rmse": 0.672,
}


def test_a_model_in_one_line() -> None:
    made = {**METHODS, **MADE, "status": "incomplete", "message": "the model holds ..."}
    assert summary(made) == "incomplete: 12 of 18 images, 1,323 points, 0.97 px, 0.7 m"
    # The reason stands below the table at the end.
    assert summary({"status": "no_features", "message": "2 of 3 images have no keypoints"}) == (
        "no_features"
    )
    assert summary({"status": "no_model", "message": None}) == "no_model"


def test_events_count_what_is_there() -> None:
    events: list[Event] = []
    tell = ReconstructionProgress(events.append)
    tell.read(1, 2)
    tell.left_out([Combination.parse("ORB-LUCID-HAM-BF")], "images are gray")
    tell.planned(3, 1)
    tell.watch([])
    tell.finished({**METHODS, **MADE, "status": "ok"})
    assert [(event.stage, event.done, event.total) for event in events] == [
        ("reading images", 1, 2),
        ("reconstructing", 0, 0),
        ("reconstructing", 1, 3),
        ("reconstructing", 1, 3),
        ("reconstructing", 2, 3),
    ]
    assert [event.message for event in events if event.message] == [
        "left out: 1 combination, because images are gray",
        "1 of 3 models are already finished",
        "2 of 3  ORB-ORB-HAM-BF  ok: 12 of 18 images, 1,323 points, 0.97 px, 0.7 m",
    ]
    assert [row["status"] for row in events[-1].rows] == ["ok"]
    assert events[-1].share == 0.5


def test_processes_tell_how_far_their_models_are() -> None:
    events: list[Event] = []
    tell = ReconstructionProgress(events.append)
    tell.planned(2, 0)
    matching = StageCall("match", -1, "a and b", "ORB", "ORB", "ORB-ORB-HAM-BF", 9, 17)
    assert matching.brief() == "match pair 9 of 17, ORB-ORB-HAM-BF"
    # 8 of 17 pairs of the part between .25 and .45 of a model; the other one is being mapped.
    mapping = StageCall("mapping", -1, "18 images", "ORB", "ORB", "ORB-ORB-HAM-BF")
    assert mapping.brief() == "mapping ORB-ORB-HAM-BF on 18 images"
    tell.watch([Activity(0, matching, 1.0), Activity(1, mapping, 1.0)])
    assert events[-1].share == pytest.approx((0.34 + 0.8) / 2)
    # A share does not fall, whatever a process turns to.
    tell.watch([Activity(0, None, 0.0)])
    assert events[-1].share == pytest.approx(0.57)
    assert share_of_model(None) == 0.0


def test_models_without_time_are_told_where_there_is_a_deadline() -> None:
    events: list[Event] = []
    tell = ReconstructionProgress(events.append)
    orb, sift = (Combination.parse(name) for name in ("ORB-ORB-HAM-BF", "SIFT-SIFT-L2-BF"))
    left = RemainingTime(math.inf)
    tell.without_time([BASELINE], left)
    assert events == []
    left = RemainingTime(0.0)
    tell.without_time([], left)
    assert events == []
    tell.without_time([BASELINE, orb, sift], left)
    tell.without_time([orb, sift], left)
    left.worked(orb, 21.0, made=True)
    tell.without_time([sift], left)
    assert [event.message for event in events] == [
        "no time for 3 models: COLMAP's default, which is made first, was not finished",
        "no time for 2 models: ORB-ORB-HAM-BF, which is made next, was not finished",
        "no time for 1 model: each takes about 21 s",
    ]
