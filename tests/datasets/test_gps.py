from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image as PillowImage

from aerocues.datasets.dataset import GpsPosition
from aerocues.datasets.gps import east_north_up, position_from_tags
from aerocues.datasets.metadata import read_metadata

NORTH_EAST = {1: "N", 2: (46.0, 30.0, 36.0), 3: "E", 4: (9.0, 15.0, 0.0)}


def test_degrees_minutes_seconds_and_references() -> None:
    assert position_from_tags(NORTH_EAST) == GpsPosition(46.51, 9.25, None)
    south_west = {**NORTH_EAST, 1: "S\x00", 3: "w", 5: b"\x01", 6: 12.5}
    assert position_from_tags(south_west) == GpsPosition(-46.51, -9.25, -12.5)


@pytest.mark.parametrize(
    "change",
    [
        {2: None},
        {2: (46.0, float("nan"), 0.0)},
        {2: ()},
        {2: "north"},
        {2: (97.0, 0.0, 0.0)},
        {2: (0.0, 0.0, 0.0), 4: (0.0, 0.0, 0.0)},
    ],
)
def test_positions_that_make_no_sense_are_none(change: dict[int, object]) -> None:
    assert position_from_tags({**NORTH_EAST, **change}) is None


@pytest.mark.parametrize("name", ["a.jpg", "a.tif", "a.png", "a.webp"])
def test_every_format_with_exif_gives_its_position(tmp_path: Path, name: str) -> None:
    exif = PillowImage.Exif()
    exif[0x8825] = {**NORTH_EAST, 5: b"\x00", 6: 120.25}
    PillowImage.new("RGB", (32, 32)).save(tmp_path / name, exif=exif.tobytes())
    position = read_metadata(tmp_path / name).gps
    assert position is not None
    assert (position.latitude, position.longitude) == pytest.approx((46.51, 9.25))
    assert position.altitude == 120.25


@pytest.mark.filterwarnings("ignore::UserWarning")  # Pillow's, on what it skips
@pytest.mark.parametrize("name", ["a.jpg", "a.tif"])
def test_broken_exif_is_no_position_and_no_error(tmp_path: Path, name: str) -> None:
    exif = PillowImage.Exif()
    exif[0x8825] = NORTH_EAST
    PillowImage.new("RGB", (8, 8)).save(tmp_path / name, exif=exif.tobytes())
    whole = (tmp_path / name).read_bytes()
    generator = np.random.default_rng(1)
    for end in range(0, len(whole), 7):
        (tmp_path / name).write_bytes(whole[:end])
        read_metadata(tmp_path / name)
    for _ in range(300):
        damaged = bytearray(whole)
        for place in generator.integers(0, len(whole), 4):
            damaged[place] = generator.integers(0, 256)
        (tmp_path / name).write_bytes(damaged)
        read_metadata(tmp_path / name)


def test_no_position(tmp_path: Path) -> None:
    PillowImage.new("RGB", (32, 32)).save(tmp_path / "plain.png")
    (tmp_path / "broken.jpg").write_bytes(b"no image")
    for name in ("plain.png", "broken.jpg", "missing.jpg"):
        assert read_metadata(tmp_path / name).gps is None


def test_axes_and_lengths() -> None:
    origin = GpsPosition(0.0, 0.0001, 10.0)
    local = east_north_up(
        [
            GpsPosition(0.0, 1.0001, 10.0),
            GpsPosition(0.001, 0.0001),
            GpsPosition(0.0, 0.0001, 25.0),
        ],
        origin,
    )
    degree_of_equator = 6_378_147.0 * np.sin(np.pi / 180)
    assert local[0, :2] == pytest.approx([degree_of_equator, 0.0], abs=1e-6)
    assert local[1] == pytest.approx([0.0, 110.574, 0.0], abs=2e-3)
    assert local[2] == pytest.approx([0.0, 0.0, 15.0], abs=1e-6)
    assert east_north_up([]).shape == (0, 3)


places = st.builds(GpsPosition, st.floats(-80, 80), st.floats(-179, 179), st.floats(-100, 3000))


@given(origin=places, first=places, second=places)
def test_distances_do_not_depend_on_the_origin(
    origin: GpsPosition, first: GpsPosition, second: GpsPosition
) -> None:
    a, b = east_north_up([first, second], origin)
    own = east_north_up([first, second])
    assert np.linalg.norm(a - b) == pytest.approx(np.linalg.norm(own[1]), rel=1e-9, abs=1e-6)


def test_brighton_beach(shared_data: Path) -> None:
    paths = sorted((shared_data / "flights" / "brighton_beach").glob("*.jpg"))
    positions = [position for path in paths if (position := read_metadata(path).gps) is not None]
    assert len(positions) == 18
    assert positions[0].latitude == pytest.approx(46.842607, abs=1e-6)
    assert positions[0].longitude == pytest.approx(-91.994560, abs=1e-6)
    assert positions[0].altitude == pytest.approx(198.309)
    steps = np.linalg.norm(np.diff(east_north_up(positions)[:, :2], axis=0), axis=1)
    assert 5 < float(np.median(steps)) < 60
