"""What images show of the ground, against hand calculations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image as Pillow
from PIL.TiffImagePlugin import IFDRational

from aerocues.datasets.dataset import Image, PinholeCamera, TrueView
from aerocues.datasets.decoding import FileSource
from aerocues.datasets.flight_angles import ENU_FROM_NED, camera_from_ned
from aerocues.report.footprints import footprint

PLACE = (100.0, 50.0)
FOCAL_35 = 36.0
FOCAL = FOCAL_35 / np.hypot(36, 24) * np.hypot(80, 60)
"""In pixels: equivalent focal lengths go by the diagonal."""
RIGHT, AHEAD = 40 * 40 / FOCAL, 40 * 30 / FOCAL


class Flat:
    """A depth that is the same everywhere."""

    def __init__(self, metres: float) -> None:
        self.metres = metres

    def read(self) -> np.ndarray[tuple[int, int], np.dtype[np.float32]]:
        return np.full((60, 80), self.metres, np.float32)

    def content_key(self) -> str:
        return ""


def photo(folder: Path, *, pitch: float, yaw: float, focal: float | None = FOCAL_35) -> Image:
    """A photo of 80 x 60 pixels from 40 m above the start."""
    packet = (
        'drone-dji:RelativeAltitude="+40" drone-dji:GimbalRollDegree="0" '
        f'drone-dji:GimbalYawDegree="{yaw}" drone-dji:GimbalPitchDegree="{pitch}"'
    )
    exif = Pillow.Exif()
    if focal is not None:
        exif.get_ifd(0x8769).update({0x920A: IFDRational(focal), 0xA405: int(focal)})
    path = folder / f"{pitch}_{yaw}_{focal}.jpg"
    Pillow.new("RGB", (80, 60)).save(path, exif=exif, xmp=packet.encode())
    return Image(path.name, FileSource(path))


@pytest.mark.parametrize(
    ("yaw", "top_left"), [(0.0, (-RIGHT, AHEAD)), (90.0, (AHEAD, RIGHT)), (180.0, (RIGHT, -AHEAD))]
)
def test_from_straight_above_it_is_as_wide_as_height_by_focal_length(
    tmp_path: Path, yaw: float, top_left: tuple[float, float]
) -> None:
    pytest.importorskip("pycolmap")
    found = footprint(photo(tmp_path, pitch=-90, yaw=yaw), PLACE)
    assert found is not None
    np.testing.assert_allclose(found[0] - PLACE, top_left, rtol=1e-3)  # COLMAP: 43.27 mm
    np.testing.assert_allclose(found.mean(axis=0), PLACE, atol=1e-9)


def test_a_slanted_view_is_wider_far_away_and_ahead(tmp_path: Path) -> None:
    pytest.importorskip("pycolmap")
    found = footprint(photo(tmp_path, pitch=-60, yaw=0), PLACE)
    assert found is not None
    top, bottom = found[1] - found[0], found[2] - found[3]
    assert top[0] > bottom[0] > 0
    # The middle of the upper edge is at the angle atan(30 px / focal length) above the axis.
    ahead = 40 / np.tan(np.radians(60) - np.arctan(30 / FOCAL))
    np.testing.assert_allclose(found[0, 1] - PLACE[1], ahead, rtol=1e-3)  # COLMAP: 43.27 mm


def test_without_a_focal_length_or_with_the_horizon_nothing_is_known(tmp_path: Path) -> None:
    pytest.importorskip("pycolmap")
    assert footprint(photo(tmp_path, pitch=-90, yaw=0, focal=None), PLACE) is None
    assert footprint(photo(tmp_path, pitch=-10, yaw=0), PLACE) is None
    assert footprint(Image("gone.jpg", FileSource(tmp_path / "gone.jpg")), PLACE) is None


def test_true_depth_gives_exact_corners() -> None:
    camera = PinholeCamera(80, 60, 80.0, 80.0, 39.5, 29.5)
    rotation = camera_from_ned(-90, 0, 0) @ ENU_FROM_NED.T
    centre = np.array([7.0, -3.0, 90.0])
    above = Image(
        "a", FileSource(Path("a.png")), truth=TrueView(camera, rotation, centre, Flat(40))
    )
    found = footprint(above, PLACE)
    assert found is not None
    expected = [[-13, 12], [27, 12], [27, -18], [-13, -18]]
    np.testing.assert_allclose(found, expected, atol=1e-6)
    sky = TrueView(camera, rotation, centre, Flat(np.inf))
    assert footprint(Image("a", FileSource(Path("a.png")), truth=sky), PLACE) is None
