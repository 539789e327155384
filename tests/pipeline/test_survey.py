from __future__ import annotations

import math
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from aerocues.datasets.dataset import GpsPosition, Image
from aerocues.datasets.decoded import DecodedSource, pixels_of
from aerocues.datasets.decoding import FileSource
from aerocues.pipeline.block import connected_block
from aerocues.pipeline.candidates import candidate_pairs
from aerocues.pipeline.pipeline import Pipeline
from aerocues.pipeline.representative import (
    enough_pairs,
    place_of,
    representatives,
)
from aerocues.pipeline.survey import Survey, SurveyedPair, Surveyor, view_change
from tests.methods.pictures import textured

STEP, WIDTH, HEIGHT = 60, 240, 180


def flight() -> list[Image]:
    """Two strips of three images over one picture; the second one is flown back, turned by 180."""
    ground = textured(WIDTH + 2 * STEP, HEIGHT + 80, seed=3)
    views: list[NDArray[np.uint8]] = []
    for row, columns in ((0, (0, 1, 2)), (80, (2, 1, 0))):
        for column in columns:
            view = ground[row : row + HEIGHT, STEP * column : STEP * column + WIDTH]
            views.append(np.ascontiguousarray(view if row == 0 else view[::-1, ::-1]))
    return [Image(f"{i}.png", DecodedSource(pixels_of(v))) for i, v in enumerate(views)]


def test_a_survey_sees_overlap_turn_and_strips() -> None:
    calls: list[tuple[int, int]] = []
    survey = Surveyor(flight()).survey(lambda done, total: calls.append((done, total)))
    found = {(pair.image_1, pair.image_2): pair for pair in survey.pairs}
    assert found[0, 1].kind == found[3, 4].kind == "other"
    assert found[0, 1].turn == pytest.approx(0, abs=2)
    assert found[0, 1].overlap == pytest.approx(1 - STEP / WIDTH, abs=0.05)
    assert found[2, 3].kind == found[0, 5].kind == "turned"
    assert found[2, 3].turn == pytest.approx(180, abs=2)
    assert all(pair.scale == pytest.approx(1, abs=0.05) for pair in survey.pairs)
    assert calls[-1][0] == calls[-1][1] == 6 + len(survey.candidates)
    assert (survey.partners() > 0).all()


def test_an_image_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    (tmp_path / "b.png").write_bytes(b"no image")
    images = [*flight()[:2], Image("b.png", FileSource(tmp_path / "b.png"))]
    survey = Surveyor(images).survey()
    assert [name for name, _ in survey.unreadable] == ["b.png"]
    assert [(pair.image_1, pair.image_2) for pair in survey.pairs] == [(0, 1)]


def test_images_that_share_nothing_do_not_overlap() -> None:
    images = [
        Image(str(seed), DecodedSource(pixels_of(textured(WIDTH, HEIGHT, seed=seed))))
        for seed in (1, 2)
    ]
    assert Surveyor(images).survey().pairs == ()


def test_the_change_of_view_of_known_homographies() -> None:
    turn, scale = math.radians(30), 1.5
    turned = cv2.getRotationMatrix2D((50.0, 40.0), -30, scale)
    matrix = np.vstack([turned, [0, 0, 1]])
    seen = view_change(matrix, (100, 80), (100, 80))
    assert seen is not None
    assert seen[1] == pytest.approx(math.degrees(turn))
    assert seen[2] == pytest.approx(scale)
    half = view_change(np.array([[1.0, 0, 50], [0, 1, 0], [0, 0, 1]]), (100, 80), (100, 80))
    assert half == pytest.approx((0.5, 0.0, 1.0))
    assert view_change(np.diag([-1.0, 1.0, 1.0]), (100, 80), (100, 80)) is None
    assert view_change(np.array([[1.0, 0, 500], [0, 1, 0], [0, 0, 1]]), (9, 8), (9, 8)) is None
    mirrored = np.array([[-1.0, 0, 99], [0, 1, 0], [0, 0, 1]])
    assert view_change(mirrored, (100, 80), (100, 80)) is None


@pytest.mark.slow
def test_candidates_by_gps_by_number_and_by_likeness() -> None:
    images = flight()
    nothing = [None] * 6
    features = [Pipeline("SIFT-SIFT-L2-EXACT", max_keypoints=300).features(i) for i in images]
    assert len(candidate_pairs(nothing, features)) == 15
    line = [GpsPosition(40.0 + 0.001 * i, 30.0) for i in range(30)]
    by_gps = candidate_pairs(line, features * 5)
    assert (0, 1) in by_gps
    assert (0, 29) not in by_gps
    many = candidate_pairs([None] * 48, features * 8)
    assert {(0, 6), (0, 12), (0, 1)} <= set(many)
    assert len(many) < 48 * 47 / 2


def made_up(strips: int = 4, long: int = 6) -> Survey:
    """A survey with strips flown to and fro: neighbours along, turned and across two strips."""
    pairs = []
    for strip in range(strips):
        for place in range(long):
            image = strip * long + place
            if place + 1 < long:
                pairs.append(SurveyedPair(image, image + 1, 200, 0.7, 1.0, 1.0))
            for other in range(strip + 1, min(strip + 3, strips)):
                mirrored = long - 1 - place if (other - strip) % 2 else place
                turn = 179.0 if (other - strip) % 2 else 1.0
                inliers = 20 if (strip, place) == (1, 2) else 80
                pairs.append(SurveyedPair(image, other * long + mirrored, inliers, 0.4, turn, 1.0))
    unique = {(pair.image_1, pair.image_2): pair for pair in pairs}
    names = tuple(str(i) for i in range(strips * long))
    return Survey(names, tuple(unique), tuple(unique.values()))


def test_representatives_hold_all_images_and_all_classes() -> None:
    survey = made_up()
    found = representatives(survey, 14, seed=1)
    assert len(found.pairs) == 14
    assert found.held == len(survey.images)
    assert found.components == 1
    places = [place_of(pair) for pair in found.pairs]
    assert set(places) == {"turned", "along", "across"}
    assert 3 <= places.count("turned") <= 8
    assert found == representatives(survey, 14, seed=1)
    assert found.pairs != representatives(survey, 14, seed=2).pairs


def test_the_weakest_links_that_hold_a_flight_together_are_among_them() -> None:
    survey = made_up()
    bridge = SurveyedPair(23, 24, 18, 0.2, 170.0, 1.0)
    lonely = Survey((*survey.images, "24"), survey.candidates, (*survey.pairs, bridge))
    for seed in range(5):
        assert bridge in representatives(lonely, 13, seed=seed).pairs


def test_few_pairs_are_all_taken_and_groups_are_counted() -> None:
    pairs = (
        SurveyedPair(0, 1, 50, 0.5, 0.0, 1.0),
        SurveyedPair(2, 3, 50, 0.5, 0.0, 1.0),
    )
    found = representatives(Survey(tuple("abcde"), (), pairs), 24)
    assert found.pairs == pairs
    assert (found.held, found.components) == (4, 2)
    assert enough_pairs(100, 24) == 50
    assert enough_pairs(10, 24) == 24


def test_a_block_is_connected_and_spans_strips() -> None:
    survey = made_up()
    block = connected_block(survey, 8)
    assert len(block) == 8
    inside = {int(name) for name in block}
    pairs = [pair for pair in survey.pairs if {pair.image_1, pair.image_2} <= inside]
    assert {place_of(pair) for pair in pairs} >= {"turned", "along"}
    part = Survey(tuple(block), (), ())
    assert connected_block(part, 3) == block[:3]
    assert len(connected_block(survey, 99)) == len(survey.images)
