"""Images turned by quarters, and positions turned back: exact, and the same for every stage."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import aerocues
from aerocues.datasets.dataset import Dataset, Image, Pixels, with_turns
from aerocues.datasets.decoded import DecodedSource
from aerocues.datasets.decoding import FileSource
from aerocues.errors import SelectionError
from aerocues.evaluation import run_settings
from aerocues.evaluation.run import plan_run
from aerocues.methods import plugins
from aerocues.methods.arrays import Features, Keypoints, Matches
from aerocues.methods.combination import Combination
from aerocues.methods.registry import opencv_methods
from aerocues.modelling.reconstruct import open_as_measured
from aerocues.pipeline.clock import Clock
from aerocues.pipeline.feature_folder import FeatureFolder
from aerocues.pipeline.feature_source import FeatureSource
from aerocues.pipeline.features import as_seen
from aerocues.pipeline.protocol import MeasurementProtocol
from aerocues.pipeline.survey import Survey, SurveyedPair, Surveyor
from aerocues.pipeline.turning import turned_keypoints, turned_pixels, turned_points, turned_size
from aerocues.pipeline.upright import turns_to_common_heading
from tests.evaluation.inline import InlineEngine
from tests.evaluation.scenes import strip, write_dataset
from tests.methods.pictures import textured

SIFT = Combination.parse("GFTT-SIFT-L2-BF")


@pytest.mark.parametrize("turn", [0, 90, 180, 270])
def test_points_go_with_their_pixels_and_come_back(turn: int) -> None:
    image = np.zeros((20, 30, 3), np.uint8)
    image[4, 7] = 255
    turned = turned_pixels(Pixels(image), turn).bgr
    [[x, y]] = turned_points(np.array([[7, 4]]), (30, 20), turn).tolist()
    assert turned[int(y), int(x)].tolist() == [255, 255, 255]
    assert turned.shape[1::-1] == turned_size((30, 20), turn)
    keypoints = replace(Keypoints.from_xy(np.array([[7.5, 4.25]])), angle=np.array([10.0], "f4"))
    there = turned_keypoints(keypoints, (30, 20), turn)
    back = turned_keypoints(there, turned_size((30, 20), turn), -turn)
    assert back.xy.tolist() == [[7.5, 4.25]]
    assert back.angle == pytest.approx(10.0)
    assert there.angle == pytest.approx((10 - turn) % 360)


def source(image: Image, folder: FeatureFolder | None = None) -> Features:
    made = FeatureSource(opencv_methods(), MeasurementProtocol(), Clock(0), folder=folder)
    return made.features(image, SIFT).features


def test_features_of_a_turned_image_lie_where_they_are_in_the_image(tmp_path: Path) -> None:
    pixels = textured(160, 120)
    image = Image("1", DecodedSource(Pixels(pixels)), turn=90)
    turned = Image("1", DecodedSource(Pixels(np.ascontiguousarray(np.rot90(pixels)))))
    found, seen = source(image), source(turned)
    assert np.array_equal(found.descriptors, seen.descriptors)
    assert np.array_equal(as_seen(found).keypoints.xy, seen.keypoints.xy)
    assert as_seen(found).image_size == seen.image_size == (120, 160)
    assert found.image_size == (160, 120)
    xy = turned_points(found.keypoints.xy, (160, 120), 90)
    assert np.array_equal(xy, seen.keypoints.xy)
    folder = FeatureFolder(tmp_path, opencv_methods(), MeasurementProtocol(), "here")
    for _ in range(2):
        again = source(image, folder)
        assert (again.turn, again.image_size) == (90, (160, 120))
        assert np.array_equal(again.keypoints.xy, found.keypoints.xy)
    assert not np.array_equal(source(replace(image, turn=0), folder).descriptors, found.descriptors)


def survey(names: str, *pairs: tuple[int, int, float]) -> Survey:
    found = tuple(SurveyedPair(one, two, 50, 0.5, turn, 1.0) for one, two, turn in pairs)
    return Survey(tuple(names), (), found)


def test_most_images_of_a_group_stay_as_they_are() -> None:
    two_strips = survey("abcdef", (0, 1, 3.0), (1, 2, -2.0), (2, 3, 178.0), (3, 4, 1.0))
    assert list(turns_to_common_heading(two_strips).values()) == [0, 0, 0, 180, 180, 0]
    quarters = survey("abcd", (0, 1, 88.0), (1, 2, 3.0), (2, 3, -1.0))
    assert turns_to_common_heading(quarters) == {"a": 270, "b": 0, "c": 0, "d": 0}
    # Headings of 44 and 46 degrees are the same quarter.
    between = survey("abc", (0, 1, 44.0), (1, 2, 2.0))
    assert len({*turns_to_common_heading(between).values()}) <= 2
    assert turns_to_common_heading(between)["b"] == turns_to_common_heading(between)["c"]


def test_the_yaw_of_metadata_joins_groups_where_it_agrees_with_the_pixels() -> None:
    # Two strips that pairs join, and two images that none joins.
    flight = survey("abcdef", (0, 1, 2.0), (1, 2, 178.0), (2, 3, 1.0))
    yaws = dict(zip("abcdef", (40.0, 38.0, -138.0, -140.0, 41.0, -141.0), strict=True))
    assert list(turns_to_common_heading(flight, yaws).values()) == [0, 0, 180, 180, 0, 180]
    assert turns_to_common_heading(flight, {**yaws, "c": 38.0})["f"] == 0
    # Without a turn that the pixels show, yaws prove nothing: images may have been turned since.
    apart = survey("abcd", (0, 1, 2.0), (2, 3, 1.0))
    known = dict(zip("abcd", (40.0, 38.0, -138.0, -140.0), strict=True))
    assert set(turns_to_common_heading(apart, known).values()) == {0}


@pytest.mark.parametrize("names", ["abcd", "bacd"])
def test_a_turn_between_any_two_images_counts_whichever_is_first(names: str) -> None:
    """Of 80 degrees between b and c; a lies in the middle."""
    a, b, c = (names.index(name) for name in "abc")
    flight = survey(names, (a, b, -40.0), (a, c, 40.0))
    yaws = {"a": 0.0, "b": 40.0, "c": -40.0, "d": 180.0}
    assert turns_to_common_heading(flight, yaws)["d"] == 180


def test_nothing_is_surveyed_before_arguments_are_checked_or_without_time(
    as_flown: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Surveyor, "survey", lambda self, progress: pytest.fail("surveyed"))
    for call in (aerocues.run, aerocues.recommend, aerocues.reconstruct):
        with pytest.raises(SelectionError):
            call(as_flown, "SIFT-NOTHING-L2-BF", tmp_path / "none", upright=True)
    assert not (tmp_path / "none").exists()
    spent = time.monotonic() - 60
    with pytest.raises(SelectionError, match="surveying the flight"):
        aerocues.recommend(as_flown, "SIFT-*,ORB-*", tmp_path, upright=True, budget=60, began=spent)


def test_a_flight_is_surveyed_once_for_a_plan(
    as_flown: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened = aerocues.open_dataset(str(as_flown_folder(as_flown)))
    made = Survey(
        tuple(image.name for image in opened.images),
        ((0, 1), (1, 2)),
        tuple(SurveyedPair(one, one + 1, 50, 0.5, 180.0, 1.0) for one in (0, 1)),
    )
    surveys: list[Survey] = []

    def survey(self: Surveyor, progress: object) -> Survey:
        surveys.append(made)
        return made

    monkeypatch.setattr(Surveyor, "survey", survey)
    monkeypatch.setattr(run_settings, "FEWEST_SURVEYED", 3)
    passes = plan_run(opened, str(SIFT), tmp_path / "none", upright=True, timing="shared")
    assert len(surveys) == 1
    assert [plan.rows_planned for _, plan in passes] == [2]


class Noted:
    """A matcher that remembers the sizes and places that it is told."""

    dtypes: Any = {"L2": ("float32",)}  # noqa: RUF012
    told: Any = []  # noqa: RUF012

    def match(self, features_1: Features, features_2: Features, norm: str) -> Matches:
        self.told.append((features_1.image_size, features_2.image_size))
        return Matches()


@pytest.fixture(scope="module")
def as_flown(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Three views, the second of which was taken upside down."""
    views = strip(3)
    names = list(views)
    views[names[1]] = np.ascontiguousarray(views[names[1]][::-1, ::-1])
    return write_dataset(tmp_path_factory.mktemp("flown"), views)


def as_flown_folder(dataset: Dataset) -> Path:
    source = dataset.images[0].source
    assert isinstance(source, FileSource)
    return source.path.parent


def test_upright_methods_match_images_that_are_turned_back(
    as_flown: Dataset, tmp_path: Path
) -> None:
    upright = aerocues.upright(as_flown)
    assert [image.turn for image in upright.images] == [0, 180, 0]
    assert "1 of 3" in upright.notes[-1]
    right = {}
    options: dict[str, Any] = {"timing": "shared", "preset": "thesis", "engine": InlineEngine()}
    events: list[aerocues.Event] = []
    for name in ("plain", "upright"):
        options |= {"upright": name == "upright", "progress": events.append}
        results = aerocues.run(as_flown, str(SIFT), tmp_path / name, **options)
        rows = results.table().sort("pair").to_dicts()
        right[name] = [row["inliers"] for row in rows]
        turns = [(row["turned_1"], row["turned_2"]) for row in rows]
        assert turns == ([(None, None)] * 2 if name == "plain" else [(0, 180), (180, 0)])
    assert {event.message for event in events} & {upright.notes[-1]}
    assert any(event.stage == "surveying the flight" and event.total for event in events)
    reopened = open_as_measured(as_flown_folder(as_flown), results)
    assert [image.turn for image in reopened.images] == [0, 180, 0]
    assert min(right["upright"]) > 100
    assert max(right["plain"]) < 0.3 * min(right["upright"])


def test_matchers_and_pair_matchers_see_turned_images(
    as_flown: Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plugins, "_REGISTERED", {})
    aerocues.register("matcher", "NOTED", Noted)
    aerocues.register("pair_matcher", "FOLLOW", "tests.methods.following:Follow")
    first, second = with_turns(as_flown, {"view_0.png": 0}).images[:2]
    quarter = replace(second, turn=90)
    aerocues.match(first, quarter, "SIFT-SIFT-L2-NOTED")
    width, height = second.read().bgr.shape[1::-1]
    assert Noted.told[-1] == ((width, height), (height, width))
    matched = aerocues.match(first, replace(second, turn=180), "FOLLOW")
    assert matched.beats_chance
    middle = (matched.points_1 + matched.points_2).mean(axis=0) / 2
    assert np.abs(middle - np.array([width, height]) / 2).max() < 40
