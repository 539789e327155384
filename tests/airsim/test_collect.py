from __future__ import annotations

import json
import re
import socket
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from aerocues.airsim.collect import Collection, collect
from aerocues.cli.program import exit_code
from aerocues.datasets.catalog import open_dataset
from aerocues.errors import SimulationError
from aerocues.simulation.camera import Pose
from aerocues.simulation.flight import Flown, Settings, fly
from aerocues.simulation.rendering import Rendering, render
from aerocues.simulation.scenes import build_scene, stage
from aerocues.simulation.sensor import develop
from aerocues.simulation.surveys import Shot, Survey
from tests.airsim.server import Simulator, of_rendering, plain, serving

SURVEY = Survey(
    "short",
    (
        Shot("Layer1/000_a", Pose(0, 0, -40, -90, 0)),
        Shot("Layer1/001_b", Pose(8, 3, -40, -60, 10)),
        Shot("Layer2/000_c", Pose(8, -3, -60, -120, -90)),
        Shot("Layer2/001_d", Pose(0, 0, -30, -10, 200)),
    ),
)
ASKED = Collection(width=60, height=40, timeout=5.0)


def waits() -> tuple[list[float], Callable[[float], None]]:
    waited: list[float] = []
    return waited, waited.append


@pytest.mark.parametrize("flavour", ["airsim", "cosys"])
@pytest.mark.parametrize("told", [True, False])
def test_a_survey_is_collected_with_its_truth(tmp_path: Path, flavour: str, told: bool) -> None:
    simulator = Simulator(flavour)
    with serving(simulator) as port:
        asked = replace(ASKED, port=port, flavour=flavour if told else None)
        assert collect(tmp_path, SURVEY, asked) == Flown(4, 0)
        assert not simulator.paused
        assert simulator.photographs == 4
        assert collect(tmp_path, SURVEY, asked) == Flown(0, 4)
        assert simulator.photographs == 4
    assert (simulator.fov, simulator.width) == (90.0, 60)
    dataset = open_dataset(f"airsim:{tmp_path}")
    assert [image.name for image in dataset.images] == [f"{shot.name}.png" for shot in SURVEY.shots]
    assert len(dataset.pairs) == 2
    for image, shot in zip(dataset.images, SURVEY.shots, strict=True):
        rgb, depth = plain(shot.pose, 60, 40, 90.0)
        np.testing.assert_array_equal(image.read().bgr[..., ::-1], rgb)
        assert image.truth is not None
        assert image.truth.depth is not None
        np.testing.assert_array_equal(image.truth.depth.read(), depth)
        assert image.gps is not None
    # The last one looks at the horizon: there is sky, and it is infinitely far.
    assert np.isinf(depth).any()
    facts = json.loads((tmp_path / "truth/camera.json").read_text())
    assert (facts["flavour"], facts["fov"]) == (flavour, 90.0)


@pytest.mark.slow
def test_what_the_embedded_renderer_shows_is_what_it_would_have_written(tmp_path: Path) -> None:
    settings = Settings(width=60, height=40)
    survey = Survey("two", SURVEY.shots[:2])
    assert fly(tmp_path / "own", survey, settings) == Flown(2, 0)
    # The same scene behind the protocol; each image has the noise of its number.
    from aerocues.simulation.flight import _half

    scene = build_scene(settings.scene, settings.seed, _half(survey, settings.camera))
    lit = stage(scene, settings.weather)
    numbers = iter(range(2))

    def see(pose: Pose) -> tuple[np.ndarray, Rendering]:
        seen = render(lit, settings.camera, pose)
        noise = np.random.default_rng([settings.seed, next(numbers)])
        return develop(seen.radiance, settings.sensor, noise), seen

    with serving(Simulator("cosys", of_rendering(see))) as port:
        collect(tmp_path / "airsim", survey, replace(ASKED, port=port, timeout=60.0))
    for shot in survey.shots:
        own, theirs = (
            np.asarray(Image.open(tmp_path / each / f"{shot.name}.png")).astype(int)
            for each in ("own", "airsim")
        )
        # A turn as a quaternion and back rounds in the last digit.
        assert np.mean(own != theirs) < 0.01
        depths = [
            np.load(tmp_path / each / "truth/depth" / f"{shot.name}.npy")
            for each in ("own", "airsim")
        ]
        assert np.mean(np.abs(depths[0] - depths[1]) > 1e-3) < 0.01


def test_a_lost_connection_is_made_anew(tmp_path: Path) -> None:
    simulator = Simulator(drop_after=2)
    waited, sleep = waits()
    with serving(simulator) as port:
        flown = collect(tmp_path, SURVEY, replace(ASKED, port=port), sleep=sleep)
    assert flown == Flown(4, 0)
    assert waited == [0.5]
    assert simulator.calls.count("simSetCameraFov") == 2


def test_a_simulator_that_stays_away_costs_nothing_that_is_finished(tmp_path: Path) -> None:
    simulator = Simulator(drop_after=2)
    waited, sleep = waits()

    def vanish(seconds: float) -> None:
        simulator.gone = True
        sleep(seconds)

    with serving(simulator) as port:
        asked = replace(ASKED, port=port)
        with pytest.raises(SimulationError, match=r"127\.0\.0\.1"):
            collect(tmp_path, SURVEY, asked, sleep=vanish)
        assert waited == [0.5, 1.0, 2.0, 4.0, 8.0]
        simulator.gone = False
        assert collect(tmp_path, SURVEY, asked) == Flown(2, 2)
    assert simulator.photographs == 4


def test_no_simulator_is_told_and_nothing_is_touched(tmp_path: Path) -> None:
    with serving(Simulator()) as port:
        collect(tmp_path, SURVEY, replace(ASKED, port=port))
    other = Survey("other", SURVEY.shots[:1])
    with pytest.raises(SimulationError, match=r"127\.0\.0\.1:"):
        collect(tmp_path, other, replace(ASKED, port=port))
    assert len(list(tmp_path.rglob("*.png"))) == 4


def test_a_camera_that_does_not_move_is_found_out(tmp_path: Path) -> None:
    with (
        serving(Simulator(stuck=True)) as port,
        pytest.raises(SimulationError, match="40 m and 90 degrees"),
    ):
        collect(tmp_path, SURVEY, replace(ASKED, port=port))
    assert not list(tmp_path.rglob("*.png"))


@pytest.mark.parametrize(
    ("simulator", "told"),
    [
        (Simulator(width=32, height=32), r'32 x 32 pixels.*"Width": 60, "Height": 40'),
        (Simulator(fixed_fov=True), r'70 degrees .*"FOV_Degrees": 90'),
    ],
)
def test_settings_of_the_simulator_that_do_not_fit(
    tmp_path: Path, simulator: Simulator, told: str
) -> None:
    with serving(simulator) as port, pytest.raises(SimulationError, match=told):
        collect(tmp_path, SURVEY, replace(ASKED, port=port))
    assert not simulator.paused


def test_a_wrong_flavour_names_the_right_one(tmp_path: Path) -> None:
    for server, asked in (("airsim", "cosys"), ("cosys", "airsim")):
        with (
            serving(Simulator(server)) as port,
            pytest.raises(SimulationError, match=f"`flavour=.{server}"),
        ):
            collect(tmp_path, SURVEY, replace(ASKED, port=port, flavour=asked))


def test_what_answers_but_is_no_simulator(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        port = listening.getsockname()[1]
        asked = replace(ASKED, port=port, timeout=0.2)
        with pytest.raises(SimulationError, match=r"127\.0\.0\.1"):
            collect(tmp_path, SURVEY, asked)


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    simulator = Simulator("cosys")
    with serving(simulator) as port:
        words = ["airsim", "collect", "-o", str(tmp_path), "--survey", "mini", "--port", str(port)]
        assert exit_code([*words, "--size", "60x40"]) == 0
        told = capsys.readouterr().out
        assert re.search(rf"6 images .*{tmp_path}.*aerocues run airsim:", told)
        assert exit_code([*words, "--size", "50x40"]) == 2
        assert "60 x 40" in capsys.readouterr().err
    assert exit_code(words) == 2
    told = capsys.readouterr().err
    assert told.startswith("error: no simulator answers")
    assert told.count("\n") == 1
