"""`aerocues use` on the command line."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

import aerocues
from aerocues.cli.program import exit_code
from aerocues.cli.use import As
from aerocues.exports.targets import TARGETS
from tests.cli.conftest import Call
from tests.reconstruction.scenes import GRID, write_scene

NAME = "ORB-ORB-HAM-BF"


def test_every_target_has_its_word() -> None:
    assert [each.value for each in As] == [each.name for each in TARGETS]


def test_a_program_goes_to_standard_output_or_a_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert exit_code(["use", NAME]) == 0
    printed = capsys.readouterr().out
    compile(printed, "program.py", "exec")
    file = tmp_path / "program.cpp"
    assert exit_code(["use", NAME, "--as", "cpp", "-o", str(file)]) == 0
    assert "int main" in file.read_text()
    assert NAME in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "combination"),
        (["ORB-*-HAM-BF"], "name one"),
        ([NAME, "photos", "--as", "python"], "IMAGES"),
        ([NAME, "photos", "--as", "colmap"], "--output"),
        ([NAME, "--as", "colmap", "-o", "there"], "IMAGES"),
        ([NAME, "--seed", "-1"], "0 or more"),
    ],
)
def test_mistakes_are_told_in_one_line(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert exit_code(["use", *words]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert said in told


def test_a_folder_with_other_files_stays_as_it_is(
    photos: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    assert exit_code(["use", NAME, str(photos), "--as", "colmap", "-o", str(tmp_path)]) == 2
    assert "mine.txt" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_what_a_tool_needs_is_asked_for_first(
    photos: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: Call
) -> None:
    words = ("use", NAME, photos, "--as", "hloc", "-o", tmp_path / "out")
    monkeypatch.setattr("aerocues.exports.targets.find_spec", lambda name: None)
    answer = call(*words)
    assert (answer.code, "aerocues[exports]" in answer.err) == (2, True)
    assert not (tmp_path / "out").exists()
    spaced = tmp_path / "images"
    spaced.mkdir()
    for number in range(2):
        shutil.copyfile(photos / f"{number}.png", spaced / f"image {number}.png")
    answer = call("use", NAME, spaced, "--as", "bundler", "-o", tmp_path / "out")
    assert (answer.code, "image 0.png" in answer.err) == (2, True)


def test_a_program_of_turned_images_is_refused(finished: Path, tmp_path: Path, call: Call) -> None:
    turned = tmp_path / "turned"
    shutil.copytree(finished, turned)
    settings = json.loads((turned / "run.json").read_text())
    settings["dataset"]["turned"] = {"0.png": 180}
    (turned / "run.json").write_text(json.dumps(settings))
    answer = call("use", "ORB-ORB-HAM-BF", "--from", turned, "--as", "python")
    assert (answer.code, "common heading" in answer.err) == (2, True)
    answer = call("use", "ORB-ORB-HAM-BF", "--upright", "--as", "python")
    assert (answer.code, "--upright" in answer.err) == (2, True)


@pytest.mark.slow
def test_files_are_written_and_can_be_written_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    images = tmp_path / "images"
    write_scene(images, GRID[:4])
    words = ["use", NAME, str(images), "--as", "openmvg", "-o", str(tmp_path / "out")]
    words += ["--max-keypoints", "500", "--features", str(tmp_path / "features")]
    assert exit_code(words) == 0
    first = capsys.readouterr().out
    record = json.loads((tmp_path / "out" / "aerocues.json").read_text())
    assert record["images"] == 4
    assert record["verified_matches"] > 200
    assert f"{record['verified_matches']:,}" in first
    assert "next     openMVG_main_SfM" in first
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        *("aerocues.json", "images", "matches", "sfm_data.json")
    ]
    matches = (tmp_path / "out" / "matches" / "matches.f.txt").read_bytes()
    kept = sorted((tmp_path / "features").rglob("*.npz"))
    written = {path: path.stat().st_mtime_ns for path in kept}
    assert kept
    assert exit_code(words) == 0
    assert (tmp_path / "out" / "matches" / "matches.f.txt").read_bytes() == matches
    assert {path: path.stat().st_mtime_ns for path in kept} == written
    words[words.index("openmvg")] = "colmap"
    assert exit_code(words) == 2
    assert "openmvg" in capsys.readouterr().err


@pytest.mark.slow
def test_images_and_settings_are_those_of_the_results(tmp_path: Path) -> None:
    images = tmp_path / "images"
    write_scene(images, GRID[:4])
    measured = aerocues.open_dataset(images, max_width=400, max_pairs=2)
    features = tmp_path / "features"
    results = aerocues.run(
        measured,
        NAME,
        tmp_path / "results",
        max_keypoints=300,
        features=features,
        workers=1,
        timing="shared",
    )
    kept = {path: path.stat().st_mtime_ns for path in features.rglob("*.npz")}
    used = aerocues.use(output=tmp_path / "out", target="bundler", results=results)
    assert used.combination == NAME
    assert {path: path.stat().st_mtime_ns for path in kept} == kept
    assert used.figures["images"] == 4
    assert used.figures["keypoints"] <= 4 * 300
    lines = (tmp_path / "out" / "list.txt").read_text().splitlines()
    assert len(lines) == 4
    assert str(used).startswith("images")
