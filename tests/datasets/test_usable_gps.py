"""GPS positions that cannot be right, among those of made-up flights."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image as PillowImage

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import GpsPosition
from aerocues.datasets.gps import east_north_up
from aerocues.datasets.usable_gps import UsableGps, told_left_out

DEGREE = 111_320.0


def grid(columns: int = 4, rows: int = 3, altitude: float | None = 182.0) -> list[GpsPosition]:
    """A survey: images 20 m apart."""
    return [
        GpsPosition(47.6 + 20 * row / DEGREE, -122.1 + 30 * column / DEGREE, altitude)
        for row in range(rows)
        for column in range(columns)
    ]


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"longitude": -121.51}, r"44.\d km from the others"),
        ({"latitude": 0.0}, "latitude 0"),
        ({"longitude": 0.0}, "longitude 0"),
        ({"altitude": 0.0}, "altitude 0"),
        ({"altitude": None}, "no altitude"),
        ({"altitude": 1482.0}, "altitude 1.3 km from the others"),
        ({"altitude": -900.0}, "altitude 1.1 km from the others"),
    ],
)
@pytest.mark.parametrize("number", [0, 5, 11])
def test_a_position_that_cannot_be_right_is_told(
    number: int, change: dict[str, Any], fault: str
) -> None:
    flight = grid()
    flight[number] = replace(flight[number], **change)
    found = UsableGps.of(flight).faults
    assert re.fullmatch(fault, found[number] or "")
    assert found.count(None) == len(flight) - 1


def test_a_third_of_the_positions_may_be_wrong() -> None:
    flight: list[GpsPosition | None] = [*grid(3, 2)]
    flight[0], flight[4] = GpsPosition(51.5, 0.0, 20.0), GpsPosition(10.0, 20.0, 182.0)
    found = UsableGps.of(flight).faults
    assert found[0] == "longitude 0"
    assert (found[4] or "").endswith("km from the others")
    assert found.count(None) == 4


@given(st.integers(0, 1000), st.floats(0, 90), st.integers(1, 12), st.integers(2, 12))
def test_nothing_is_left_out_of_a_sound_survey(
    seed: int, turn: float, rows: int, columns: int
) -> None:
    generator = np.random.default_rng(seed)
    angle = np.radians(turn)
    flight = []
    for row in range(rows):
        for column in range(columns):
            x, y = 90.0 * column, 60.0 * row
            east, north, up = generator.normal(scale=5, size=3)
            east += x * np.cos(angle) - y * np.sin(angle)
            north += x * np.sin(angle) + y * np.cos(angle)
            flight.append(GpsPosition(10 + north / DEGREE, 20 + east / DEGREE, 60 + up))
    usable = UsableGps.of(flight)
    assert usable.faults == [None] * len(flight)
    located = usable.horizontal()
    assert located is not None
    np.testing.assert_array_equal(located, east_north_up(flight)[:, :2])


def test_what_is_left_out_in_words() -> None:
    assert told_left_out(dict.fromkeys("abcde", "no altitude")) == (
        "GPS left out: a (no altitude), b (no altitude), c (no altitude) and 2 more"
    )


def test_pairs_by_gps_tell_the_positions_that_they_do_not_use(tmp_path: Path) -> None:
    for number in range(5):
        exif = PillowImage.Exif()
        if number != 2:
            exif[0x8825] = {1: "N", 2: (46.0, 0.0, number / 2), 3: "E", 4: (9.0, 0.0, 0.0)}
        PillowImage.new("RGB", (32, 32), (number, 0, 0)).save(tmp_path / f"{number}.jpg", exif=exif)
    dataset = open_dataset(str(tmp_path), pairs="gps:1")
    assert ("1.jpg", "2.jpg") in [(pair.image_1, pair.image_2) for pair in dataset.pairs]
    assert dataset.notes == ("GPS left out: 2.jpg (no GPS position)",)


def test_two_sites_are_a_flight_of_two_parts() -> None:
    far = [replace(each, latitude=each.latitude + 0.02) for each in grid()]
    assert UsableGps.of([*grid(), *far]).faults == [None] * 24


def test_a_flight_at_the_coast_has_altitudes_of_zero() -> None:
    heights = [-4.0, 0.0, 3.0, 6.0, 0.0, 2.0]
    flight = [
        replace(each, altitude=height) for each, height in zip(grid(3, 2), heights, strict=True)
    ]
    assert UsableGps.of(flight).faults == [None] * 6


def test_without_altitudes_all_are_at_the_same_level() -> None:
    flight = grid(altitude=None)
    flight[3] = replace(flight[3], altitude=100.0)
    assert UsableGps.of(flight).faults == [None] * 12
    assert np.ptp(east_north_up(grid(altitude=None))[:, 2]) < 0.01


def test_an_image_without_a_place_is_between_its_neighbours() -> None:
    flight: list[GpsPosition | None] = [*grid(5, 1)]
    expected = east_north_up([each for each in flight if each])[:, :2]
    flight[1], flight[3] = None, replace(grid()[3], latitude=0.0)
    found = UsableGps.of(flight).horizontal()
    assert found is not None
    np.testing.assert_allclose(found, expected, atol=1e-3)
    assert UsableGps.of([None, None, None, *grid(2, 1)]).horizontal() is None
