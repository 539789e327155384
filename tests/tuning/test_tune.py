"""From images to a preset: what pays is kept, what does not stays at its default."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

from aerocues.methods.presets import preset_named
from tests.cli.conftest import Answer, Call, write_views

WORKERS = ("--workers", 1)


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Views of a plane, several copies of which are several projects."""
    folder = tmp_path_factory.mktemp("scenes") / "projects"
    for name in ("north", "south"):
        write_views(folder / name)
    return folder


def tune(call: Call, methods: str, scenes: Path, preset: Path, *more: object) -> Answer:
    spec = f"uav:{scenes}"
    return call("tune", methods, spec, "-o", preset, "--max-keypoints", 400, *WORKERS, *more)


@pytest.mark.slow
def test_what_pays_becomes_a_preset(call: Call, scenes: Path, tmp_path: Path) -> None:
    grid = tmp_path / "grid.json"
    grid.write_text(json.dumps({"bytes": [2, 32]}))
    preset = tmp_path / "latch.json"
    # A criterion without times: how busy the machine is decides nothing.
    chosen = ("--grid", grid, "--objective", "inliers")
    answer = tune(call, "LATCH", scenes, preset, *chosen)
    assert answer.code == 0, answer.err
    assert "1 of 1: descriptor LATCH: bytes=32: +" in answer.err
    assert "1 scene" in answer.out
    assert f"--preset {preset}" in answer.out
    content = json.loads(preset.read_text())
    assert content["descriptors"] == {"LATCH": {"bytes": 32}}
    [search] = content["made"]["searches"]
    assert search["kept"] is True
    assert search["interval"][0] > 0
    assert search["judged_by"] == {"pairs": 3, "scenes": 1}
    assert search["tuned"]["inliers"] > search["default"]["inliers"]
    [dataset] = content["made"]["datasets"]
    assert not {told.split(":")[0] for told in dataset["training"]} & {
        told.split(":")[0] for told in dataset["validation"]
    }
    assert preset_named(str(preset)).descriptors == {"LATCH": {"bytes": 32}}

    # Once more, nothing is measured, and the preset is the same.
    parts = sorted((tmp_path / "latch-search" / "parts").iterdir())
    again = tune(call, "LATCH", scenes, preset, *chosen)
    assert again.out == answer.out
    assert sorted((tmp_path / "latch-search" / "parts").iterdir()) == parts
    assert json.loads(preset.read_text()) == content

    run = ("run", f"uav:{scenes}", "-o", tmp_path / "r", "--combinations", "ORB-LATCH-HAM-BF")
    assert call(*run, *WORKERS, "--preset", preset).code == 0


@pytest.mark.slow
def test_what_does_not_pay_stays(call: Call, scenes: Path, tmp_path: Path) -> None:
    grid = tmp_path / "grid.json"
    grid.write_text(json.dumps({"edge_blur_size": [5, 4]}))
    preset = tmp_path / "mser.json"
    answer = tune(call, "MSER", scenes, preset, "--grid", grid)
    assert answer.code == 0, answer.err
    assert json.loads(preset.read_text())["detectors"] == {}


def test_two_pairs_judge_nothing(call: Call, scenes: Path, tmp_path: Path) -> None:
    few = tmp_path / "few"
    for name in ("north", "south"):
        shutil.copytree(scenes / name, few / name)
        (few / name / "3.png").unlink()
    preset = tmp_path / "latch.json"
    answer = tune(call, "LATCH", few, preset)
    assert answer.code == 0, answer.err
    assert "descriptor LATCH: default; " in answer.err
    assert json.loads(preset.read_text())["descriptors"] == {}


def test_pairs_without_a_reference_tell_nothing(call: Call, tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    for scene in ("north", "south"):
        for number in range(4):
            noise = rng.integers(0, 256, (120, 160), np.uint8)
            (tmp_path / "noise" / scene).mkdir(parents=True, exist_ok=True)
            cv2.imwrite(str(tmp_path / "noise" / scene / f"{number}.png"), noise)
    preset, grid = tmp_path / "brief.json", tmp_path / "grid.json"
    grid.write_text(json.dumps({"bytes": [32, 64]}))
    answer = tune(call, "BRIEF", tmp_path / "noise", preset, "--grid", grid)
    assert answer.code == 0, answer.err
    assert "too few pairs have a reference of right matches" in answer.err
    assert json.loads(preset.read_text())["descriptors"] == {}


@pytest.mark.slow
def test_without_truth_thresholds_stay_and_large_grids_are_halved(
    call: Call, scenes: Path, tmp_path: Path
) -> None:
    preset = tmp_path / "orb.json"
    answer = tune(call, "ORB-BRIEF-HAM-BF", scenes, preset, "--objective", "excess_inliers")
    assert answer.code == 0, answer.err
    assert "threshold of ORB-BRIEF: default; " in answer.err
    content = json.loads(preset.read_text())
    assert [each["tried"] for each in content["made"]["searches"]][:2] == [12, 6]
    assert content["made"]["objective"] == "excess_inliers"


def test_time_that_is_up_leaves_the_default(call: Call, scenes: Path, tmp_path: Path) -> None:
    preset = tmp_path / "late.json"
    answer = tune(call, "detector:BRISK,BRIEF", scenes, preset, "--budget", "0.01s")
    assert answer.code == 0, answer.err
    assert answer.err.count(": default; ") == 2
    assert json.loads(preset.read_text())["descriptors"] == {}


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("SURF",), "SURF"),
        (("LATCH", "--objective", "beauty"), "'beauty'"),
        (("LATCH", "--grid", "missing.json"), "missing.json"),
        (("LATCH", "--budget", "never"), "got 'never'"),
        ((" , ",), "method"),
        (("ORB-BRIEF-HAM-BF,ORB-LATCH-HAM-BF",), "ORB-LATCH-HAM-BF"),
    ],
)
def test_mistakes_are_told(
    call: Call, scenes: Path, tmp_path: Path, words: tuple[str, ...], told: str
) -> None:
    answer = tune(call, words[0], scenes, tmp_path / "p.json", *words[1:])
    assert answer.code == 2
    assert told in answer.err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("Tuned.json", "Tuned"),
        ("thesis.json", "thesis"),
        ("folder", "folder"),
        ("file/p.json", "p.json"),
    ],
)
def test_a_preset_that_could_not_be_used_is_refused_before_the_search(
    call: Call, scenes: Path, tmp_path: Path, name: str, told: str
) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").touch()
    answer = tune(call, "LATCH", scenes, tmp_path / name)
    assert answer.code == 2
    assert told in answer.err
    assert answer.err.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder"]


def test_folders_of_one_name_are_told_apart(call: Call, photos: Path, tmp_path: Path) -> None:
    folders = [tmp_path / flight / "images" for flight in ("first", "second")]
    for folder in folders:
        shutil.copytree(photos, folder)
    preset = tmp_path / "brief.json"
    words = ("tune", "BRIEF", folders[0], "-o", preset, "--budget", "0.01s", *WORKERS)
    answer = call(*words, "--validate", folders[1])
    assert answer.code == 0, answer.err
    datasets = json.loads(preset.read_text())["made"]["datasets"]
    assert [each["name"] for each in datasets] == ["first/images", "second/images"]

    twice = call(*words, "--validate", folders[0])
    assert twice.code == 2
    assert "first/images" in twice.err


@pytest.mark.slow
def test_thresholds_are_judged_by_the_truth(call: Call, photos: Path, tmp_path: Path) -> None:
    preset = tmp_path / "p.json"
    words = ("tune", "SIFT-SIFT-L2-BF", f"synthetic:{photos / '0.png'}", "-o", preset, *WORKERS)
    answer = call(*words, "--max-keypoints", 200, "--max-pairs", 3)
    assert answer.code == 0, answer.err
    last = json.loads(preset.read_text())["made"]["searches"][-1]
    assert last["search_space"] == "threshold of SIFT-SIFT"
    assert last["tried"] == 5
