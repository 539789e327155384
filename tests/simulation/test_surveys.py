from __future__ import annotations

import json
from collections import Counter
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from aerocues.errors import SimulationError
from aerocues.simulation.camera import pinhole
from aerocues.simulation.planner import Mission, open_survey, plan
from aerocues.simulation.surveys import survey_called

CAMERA = pinhole(1000, 665, 90.0)


def test_airsimnh_has_three_layers_of_five_views() -> None:
    shots = survey_called("AirSimNH").shots
    assert len(shots) == 775
    assert Counter(shot.name.split("/")[0] for shot in shots) == {
        "Layer1": 405,
        "Layer2": 245,
        "Layer3": 125,
    }
    views = {(shot.pose.pitch, shot.pose.yaw) for shot in shots}
    assert views == {(-60, 0), (-60, -90), (-90, 0), (-120, 0), (-120, -90)}
    for down, reach in ((-60, 160), (-100, 120), (-140, 80)):
        places = {(s.pose.north, s.pose.east) for s in shots if s.pose.down == down}
        side = range(-reach, reach + 1, 40)
        assert places == {(float(n), float(e)) for n in side for e in side}
    nadir = [shot for shot in shots if shot.name.startswith("Layer3/pitch-90_yaw0/")]
    assert nadir[0].name == "Layer3/pitch-90_yaw0/000_z-140_y-80_x-80"
    assert len(nadir) == 25


def test_consecutive_nodes_are_neighbours() -> None:
    shots = [s for s in survey_called("airsimnh").shots if "Layer3/pitch-90" in s.name]
    assert [s.name for s in shots] == sorted(s.name for s in shots)
    at = np.array([(s.pose.north, s.pose.east) for s in shots])
    assert np.linalg.norm(np.diff(at, axis=0), axis=1) == pytest.approx(40.0)


def test_natural_looks_ahead() -> None:
    shots = survey_called("airsimnh-natural").shots
    assert Counter(shot.pose.down for shot in shots) == {-80: 49, -110: 25, -140: 9}
    assert {shot.pose.pitch for shot in shots} == {-60}
    assert {shot.pose.yaw for shot in shots} == {0, 180}
    for first, second in pairwise(shots[:49]):
        if first.pose.yaw == second.pose.yaw:
            ahead = second.pose.north - first.pose.north
            assert ahead == pytest.approx(40 if first.pose.yaw == 0 else -40)


def test_names_are_unique() -> None:
    for name in ("airsimnh", "airsimnh-natural", "mini"):
        shots = survey_called(name).shots
        assert len({shot.name for shot in shots}) == len(shots)


def test_a_mission_has_its_overlaps() -> None:
    survey = plan(Mission(north=100, east=90, altitude=50, front=0.8, side=0.7), CAMERA)
    ahead, beside = 66.5 * 0.2, 100 * 0.3
    north = np.array([shot.pose.north for shot in survey.shots])
    east = np.array([shot.pose.east for shot in survey.shots])
    assert (north.min(), north.max(), east.min(), east.max()) == (-50, 50, -45, 45)
    assert np.diff(np.unique(north)).max() <= ahead + 1e-9
    assert np.diff(np.unique(east)).max() <= beside + 1e-9


def test_ground_sampling_distance_sets_the_altitude() -> None:
    survey = plan(Mission(gsd=10), CAMERA)
    assert {shot.pose.down for shot in survey.shots} == {-50.0}


def test_patterns() -> None:
    double = plan(Mission("double", 60, 60, altitude=50), CAMERA)
    assert {shot.pose.yaw for shot in double.shots} == {0, 90, 180, 270}
    for shot in plan(Mission("orbit", 60, 80, altitude=50, pitch=-45), CAMERA).shots:
        towards = -np.array([shot.pose.north, shot.pose.east]) / 50
        assert shot.pose.rotation[2, :2] @ towards == pytest.approx(np.sqrt(0.5))


def test_a_mission_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "field.json"
    path.write_text(json.dumps({"pattern": "nadir", "gsd": 5, "north": 30, "east": 30}))
    assert open_survey(str(path), CAMERA).shots[0].name == "field/0000"
    path.write_text(json.dumps({"hight": 5}))
    with pytest.raises(SimulationError, match="hight"):
        open_survey(str(path), CAMERA)
    path.write_text("[1]")
    with pytest.raises(SimulationError, match="pattern"):
        open_survey(str(path), CAMERA)
    path.write_text("{")
    with pytest.raises(SimulationError, match=r"JSON \(line 1, column 2\)"):
        open_survey(str(path), CAMERA)
    with pytest.raises(SimulationError, match="airsimnh"):
        open_survey("nowhere", CAMERA)


@pytest.mark.parametrize("terms", [{}, {"altitude": 5, "gsd": 5}, {"altitude": 5, "front": 1.0}])
def test_missions_that_make_no_sense(terms: dict[str, float]) -> None:
    with pytest.raises(SimulationError):
        Mission(**terms)  # type: ignore[arg-type]
