from __future__ import annotations

import json
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as PillowImage

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import TrueView
from aerocues.datasets.gps import east_north_up
from aerocues.datasets.metadata import read_metadata
from aerocues.errors import DatasetError, SimulationError
from aerocues.simulation.camera import Pose, pinhole
from aerocues.simulation.flight import Flown, Settings, fly
from aerocues.simulation.georeference import ORIGIN, geodetic
from aerocues.simulation.metadata import gimbal_angles, write_image
from aerocues.simulation.surveys import Shot, Survey

pytestmark = pytest.mark.slow

# From low above, so that the scene is small.
SURVEY = Survey(
    "short",
    (
        Shot("Layer1/000_a", Pose(0, 0, -20, -90, 0)),
        Shot("Layer1/001_b", Pose(4, 0, -20, -80, 10)),
    ),
)
SETTINGS = Settings(width=120, height=80)


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("flight")
    assert fly(folder, SURVEY, SETTINGS) == Flown(2, 0)
    return folder


def view_of(folder: Path, number: int, max_width: int | None = None) -> TrueView:
    truth = open_dataset(f"simulated:{folder}", max_width=max_width).images[number].truth
    assert truth is not None
    return truth


def test_what_is_there_is_kept(flight: Path) -> None:
    first = flight / "Layer1/000_a.png"
    before = first.read_bytes()
    assert fly(flight, SURVEY, SETTINGS) == Flown(0, 2)
    first.unlink()
    assert fly(flight, SURVEY, SETTINGS) == Flown(1, 1)
    assert first.read_bytes() == before


def test_what_no_longer_belongs_there_goes_before_anything_is_said_of_it(tmp_path: Path) -> None:
    from aerocues.simulation.flight_folder import FlightFolder

    fly(tmp_path, SURVEY, SETTINGS)
    other = Survey("other", SURVEY.shots[1:])
    FlightFolder(tmp_path).keep({"Layer1/001_b.png": "another key"})
    assert not list(tmp_path.glob("Layer1/*.png"))
    assert fly(tmp_path, other, SETTINGS) == Flown(1, 0)
    assert [path.name for path in tmp_path.glob("Layer1/*.png")] == ["001_b.png"]


def test_consecutive_pairs_stay_within_a_view_and_subsets_are_chosen_by_folder(
    tmp_path: Path,
) -> None:
    poses = [shot.pose for shot in SURVEY.shots]
    views = ("Layer1/pitch-90", "Layer1/pitch-60", "Layer2/pitch-90")
    shots = [Shot(f"{view}/{i:03d}", pose) for view in views for i, pose in enumerate(poses)]
    fly(tmp_path, Survey("views", tuple(shots)), replace(SETTINGS, width=24, height=16))
    spec = f"simulated:{tmp_path}"
    dataset = open_dataset(spec)
    assert [(pair.image_1, pair.image_2) for pair in dataset.pairs] == [
        (f"{view}/000.png", f"{view}/001.png") for view in sorted(views)
    ]
    assert len({pair.sequence for pair in dataset.pairs}) == 1
    assert len(open_dataset(spec, pairs="exhaustive").pairs) == 15
    chosen = open_dataset(spec, subset="layer1/PITCH-90")
    assert [image.name for image in chosen.images] == [
        "Layer1/pitch-90/000.png",
        "Layer1/pitch-90/001.png",
    ]
    assert dict(chosen.settings)["subset"] == "layer1/PITCH-90"
    assert (
        len(open_dataset(spec, subset="Layer1, Layer2/*/000.png", pairs="exhaustive").images) == 5
    )
    with pytest.raises(DatasetError, match=r"`subset=.Layer3.* Layer1"):
        open_dataset(spec, subset="Layer3")
    with pytest.raises(DatasetError, match=r"`pairs=.exhaustive"):
        open_dataset(spec, subset="*/000.png")
    with pytest.raises(DatasetError, match="`sequences`"):
        open_dataset("synthetic", subset="a")


def test_a_part_of_a_survey_is_as_it_is_in_the_whole(tmp_path: Path) -> None:
    small = replace(SETTINGS, width=24, height=16)
    part, whole = tmp_path / "part", tmp_path / "whole"
    assert fly(part, SURVEY, small, subset="layer1/001*") == Flown(1, 0)
    assert [path.name for path in part.glob("Layer1/*.png")] == ["001_b.png"]
    assert fly(whole, SURVEY, small) == Flown(2, 0)
    name = "Layer1/001_b.png"
    assert (part / name).read_bytes() == (whole / name).read_bytes()
    assert fly(whole, SURVEY, small, subset=name) == Flown(0, 1)
    assert len(list(whole.glob("Layer1/*.png"))) == 2
    assert fly(part, SURVEY, small) == Flown(1, 1)
    with pytest.raises(SimulationError, match=r"`subset=.x.* Layer1"):
        fly(part, SURVEY, small, subset="x")


def test_folders_of_other_files_are_left_alone(tmp_path: Path) -> None:
    (tmp_path / "holiday.jpg").touch()
    with pytest.raises(SimulationError, match=r"holiday\.jpg"):
        fly(tmp_path, SURVEY, SETTINGS)
    with pytest.raises(SimulationError, match=r"holiday\.jpg"):
        fly(tmp_path / "holiday.jpg", SURVEY, SETTINGS)
    with pytest.raises(SimulationError, match="'moon'"):
        fly(tmp_path / "new", SURVEY, replace(SETTINGS, scene="moon"))
    assert not (tmp_path / "new").exists()


def test_the_dataset_knows_the_truth(flight: Path) -> None:
    dataset = open_dataset(f"simulated:{flight}")
    assert [(pair.image_1, pair.image_2) for pair in dataset.pairs] == [
        ("Layer1/000_a.png", "Layer1/001_b.png")
    ]
    for number, shot in enumerate(SURVEY.shots):
        view = view_of(flight, number)
        to_east_north_up = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
        rotation = shot.pose.rotation @ to_east_north_up.T
        assert view.rotation == pytest.approx(rotation, abs=1e-12)
        north, east, down = shot.pose.centre
        assert view.centre == pytest.approx((east, north, -down))
        assert view.camera == pinhole(120, 80, 90.0)
        assert view.depth is not None
        assert view.depth.read().shape == (80, 120)
    assert len(open_dataset(f"simulated:{flight / 'Layer1'}").images) == 2


def test_truth_is_scaled_with_the_images(flight: Path) -> None:
    full, half = view_of(flight, 0), view_of(flight, 0, max_width=60)
    assert (half.camera.width, half.camera.height) == (60, 40)
    assert half.camera.centre_x == pytest.approx((full.camera.centre_x + 0.5) / 2 - 0.5)
    assert full.depth is not None
    assert half.depth is not None
    assert half.depth.read().shape == (40, 60)
    assert np.median(half.depth.read()) == pytest.approx(np.median(full.depth.read()), rel=0.02)


def test_colmap_reads_the_poses(flight: Path) -> None:
    import pycolmap

    model = pycolmap.Reconstruction(str(flight / "truth/sparse"))
    assert model.num_images() == 2
    for image in model.images.values():
        number = 0 if image.name.endswith("000_a.png") else 1
        view = view_of(flight, number)
        camera, depth = view.camera, view.depth
        assert depth is not None
        values = depth.read()
        for row, column in ((10, 15), (40, 60), (70, 110)):
            ray = np.array(
                [
                    (column - camera.centre_x) / camera.focal_x,
                    (row - camera.centre_y) / camera.focal_y,
                    1.0,
                ]
            )
            place = view.rotation.T @ ray * values[row, column] + view.centre
            seen = image.project_point(place)
            assert seen == pytest.approx((column + 0.5, row + 0.5), abs=0.01)


def test_the_trajectory_has_the_centres(flight: Path) -> None:
    rows = np.loadtxt(flight / "truth/trajectory.tum")
    assert rows[:, 1:4] == pytest.approx(np.array([(0, 0, 20), (0, 4, 20)]))
    assert np.linalg.norm(rows[:, 4:], axis=1) == pytest.approx(1.0)
    assert rows[:, 0].tolist() == [0.0, 1.0]


@pytest.mark.skipif(shutil.which("exiftool") is None, reason="exiftool is not installed")
def test_exiftool_reads_what_a_drone_would_write(tmp_path: Path) -> None:
    pose = Pose(120.0, -75.0, -60.0, -120.0, -90.0)
    gps = geodetic(pose.north, pose.east, pose.down)
    for suffix in (".png", ".jpg"):
        pixels = np.zeros((80, 120, 3), np.uint8)
        write_image(tmp_path / f"a{suffix}", pixels, pinhole(120, 80, 90.0), pose, gps)
    wanted = ("-validate", "-FOV", "-GPS*", "-FocalLengthIn35mmFormat", "-Gimbal*")
    command = ["exiftool", "-json", "-n", "-G0", *wanted, str(tmp_path)]
    told = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    assert len(told) == 2
    for found in told:
        assert found["Composite:GPSLatitude"] == pytest.approx(gps.latitude, abs=1e-8)
        assert found["Composite:GPSLongitude"] == pytest.approx(gps.longitude, abs=1e-8)
        assert found["Composite:GPSAltitude"] == pytest.approx(gps.altitude, abs=1e-3)
        assert found["EXIF:FocalLengthIn35mmFormat"] == 18
        assert found["Composite:FOV"] == pytest.approx(90, abs=0.01)
        angles = [float(found[f"XMP:Gimbal{axis}Degree"]) for axis in ("Pitch", "Yaw", "Roll")]
        assert angles == pytest.approx([-60, 90, 180])
        errors, warnings, _ = (int(count) for count in found["ExifTool:Validate"].split())
        assert errors == 0
        assert warnings <= 1  # Pillow writes the components as bytes, not as undefined


@pytest.mark.parametrize("suffix", [".png", ".jpg"])
def test_positions_and_angles_are_in_the_image(tmp_path: Path, suffix: str) -> None:
    pose = Pose(120.0, -75.0, -60.0, -120.0, -90.0)
    path = tmp_path / f"a{suffix}"
    gps = geodetic(pose.north, pose.east, pose.down)
    pixels = np.zeros((80, 120, 3), np.uint8)
    write_image(path, pixels, pinhole(120, 80, 90.0), pose, gps)
    found = read_metadata(path).gps
    assert found is not None
    assert east_north_up([found], ORIGIN)[0] == pytest.approx((-75, 120, 60), abs=2e-3)
    with PillowImage.open(path) as image:
        packet = image.info["xmp"]
    text = packet.decode() if isinstance(packet, bytes) else packet
    angles = [
        float(re.findall(rf'Gimbal{axis}Degree="([^"]+)"', text)[0])
        for axis in ("Pitch", "Yaw", "Roll")
    ]
    assert angles == pytest.approx([-60, 90, 180])
    assert Pose(0, 0, 0, *angles).rotation == pytest.approx(pose.rotation, abs=1e-12)
    assert not list(tmp_path.glob(".*"))


@pytest.mark.parametrize("pitch", [-120.0, -90.0, -60.0, 10.0])
def test_folded_angles_mean_the_same(pitch: float) -> None:
    pose = Pose(0, 0, 0, pitch, 200.0, 5.0)
    folded = gimbal_angles(pose)
    assert -90 <= folded[0] <= 90
    assert Pose(0, 0, 0, *folded).rotation == pytest.approx(pose.rotation, abs=1e-12)
