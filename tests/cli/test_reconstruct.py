"""`aerocues reconstruct`: from a folder of images to models, figures in results, interruption."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from pathlib import Path

import polars as pl
import psutil
import pytest

from aerocues.results.measured_results import Results
from tests.cli.conftest import Call
from tests.reconstruction.scenes import GRID, write_scene
from tests.waiting import wait_until

PROGRAM = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "from aerocues.cli import main; main()"
)
NAMES = "SIFT-SIFT-L2-FLANN,AKAZE-AKAZE-HAM-BF"
OPTIONS = ("--no-baseline", "--focal-length", "420", "--max-keypoints", "500")


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of four overlapping photographs."""
    folder = tmp_path_factory.mktemp("reconstruct") / "flight"
    write_scene(folder, GRID[:4])
    return folder


@pytest.mark.slow
def test_models_from_results_and_figures_into_them(
    flight: Path, tmp_path: Path, call: Call
) -> None:
    results, models = tmp_path / "results", tmp_path / "models"
    wanted = f"{NAMES},ORB-ORB-HAM-BF"
    few = ("--combinations", wanted, "--timing", "shared", "--max-pairs", 3, "--workers", 1)
    assert call("run", flight, "-o", results, *few, "--max-keypoints", 500).code == 0
    words = ("reconstruct", flight, "-o", models, "--from", results, "--top", 2, *OPTIONS)
    answer = call(*words)
    assert answer.code == 0, answer.err
    assert answer.out.startswith("flight: 4 images, 6 pairs (exhaustive), ")
    assert answer.out.count("4/4") == 2
    assert any(line.startswith("1 of 2  ") for line in answer.err.splitlines())
    assert f"aerocues score {results} --reconstruction" in answer.out
    best = re.search(r"points   (.*)/points.ply", answer.out)
    assert best is not None
    assert (Path(best[1]) / "points.ply").is_file()
    assert f"colmap gui --import_path {best[1]}/sparse/0 --database_path" in answer.out
    undistort = f"colmap image_undistorter --image_path {models}/images --input_path {best[1]}"
    assert undistort in answer.out
    assert f"aerocues use {Path(best[1]).name} {flight} --max-keypoints" in answer.out
    assert "COMBINATION" not in answer.out
    table = answer.out[: answer.out.index("\nmodels   ")]
    assert max(len(line) for line in table.splitlines()) <= 100

    figures = Results(results).reconstructions()
    assert figures["status"].to_list() == ["ok", "ok"]
    assert figures["settings_key"].n_unique() == 1
    for key in figures["row_key"]:
        cloud = Results(results).cloud(key)
        assert cloud is not None
        assert len(cloud.names) == 4
    written = pl.read_csv(models / "reconstructions.csv")
    assert written["points_3d"].to_list() == figures["points_3d"].to_list()

    again = call(*words)
    assert again.err.splitlines()[-1] == "2 of 2 models are already finished"
    scored = call("score", results, "--criteria", "precision,points_3d,registered_images")
    assert scored.code == 2  # the share of the images is the criterion
    scored = call("score", results, "--criteria", "precision,points_3d,reprojection_error")
    assert scored.code == 0, scored.err
    packed = tmp_path / "packed.zip"
    assert call("results", results, "--pack", packed).code == 0
    assert Results(packed).cloud(figures["row_key"][0]) is not None

    # Other settings: what they are not comparable with goes.
    changed = call(*words[:-1], 400, "--top", 1)
    assert changed.code == 0, changed.err
    assert Results(results).reconstructions()["max_keypoints"].to_list() == [400]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "--from"),
        (("--combinations", "NONE-*"), "NONE-*"),
        (("--combinations", NAMES, "--intrinsics", "fixed"), "4 of 4 images"),
        (("--combinations", NAMES, "--top", "3"), "--from"),
        (("--combinations", NAMES, "--pairs", "gps"), "GPS"),
        (("--combinations", NAMES, "--mapper", "other"), "--mapper"),
        (("--combinations", NAMES, "--reference", "ORB-ORB-HAM-BF"), "ORB-ORB-HAM-BF"),
        (("--from", "nowhere"), "nowhere"),
    ],
)
def test_mistakes_are_told_in_one_line(
    flight: Path, tmp_path: Path, call: Call, words: tuple[str, ...], message: str
) -> None:
    answer = call("reconstruct", flight, "-o", tmp_path / "models", *words)
    assert answer.code == 2
    assert message in answer.err
    assert len(answer.err.splitlines()) == 1


@pytest.mark.parametrize("length", ["-3", "0", "nan", "inf"])
def test_what_is_no_focal_length_is_told_before_anything_is_done(
    flight: Path, tmp_path: Path, call: Call, length: str
) -> None:
    words = ("--combinations", NAMES, "--focal-length", length)
    answer = call("reconstruct", flight, "-o", tmp_path / "models", *words)
    assert answer.code == 2
    assert answer.err.startswith("error: ")
    assert "--focal-length must be a number above 0" in answer.err
    assert answer.err.count("\n") == 1
    assert not (tmp_path / "models").exists()


def test_the_path_is_told_before_missing_combinations(tmp_path: Path, call: Call) -> None:
    answer = call("reconstruct", tmp_path / "nosuch", "-o", tmp_path / "models")
    assert answer.code == 2
    assert answer.err.startswith("error: ")
    assert str(tmp_path / "nosuch") in answer.err


@pytest.mark.slow
def test_models_that_all_fail(tmp_path: Path, call: Call) -> None:
    from PIL import Image

    blank, results = tmp_path / "blank", tmp_path / "results"
    blank.mkdir()
    for name in ("a", "b", "c"):
        Image.new("RGB", (160, 120), "gray").save(blank / f"{name}.png")
    chosen = ("--combinations", "ORB-ORB-HAM-BF", "--workers", 1)
    words = ("reconstruct", blank, "-o", tmp_path / "models", *chosen, "--focal-length", 200)
    answer = call(*words)
    assert answer.code == 1
    assert answer.err.splitlines()[-1] == "2 of 2  ORB-ORB-HAM-BF  no_features"
    assert answer.out.count("ORB-ORB-HAM-BF: ") == 1
    assert "no combination beats" not in answer.out
    assert f"aerocues recommend {blank} --objective reconstruction" in answer.out
    assert call("run", blank, "-o", results, *chosen).code == 0
    answer = call(*words, "--from", results)
    assert answer.code == 1
    assert f"aerocues report {results}" in answer.out
    assert "--reconstruction" not in answer.out


def test_one_image_and_other_scenes_are_refused(
    flight: Path, finished: Path, tmp_path: Path, call: Call
) -> None:
    single = tmp_path / "single"
    single.mkdir()
    (single / "only.png").write_bytes((flight / "view_0.png").read_bytes())
    answer = call("reconstruct", single, "-o", tmp_path / "models", "--combinations", NAMES)
    assert (answer.code, str(single) in answer.err) == (2, True)
    answer = call("reconstruct", flight, "-o", tmp_path / "models", "--from", finished, *OPTIONS)
    assert answer.code == 2
    assert {"photos", "flight"} <= set(re.findall(r"\w+", answer.err))


def begin(flight: Path, output: Path) -> subprocess.Popen[str]:
    words = ["reconstruct", str(flight), "-o", str(output), "--workers", "1", *OPTIONS]
    words += ["--combinations", f"{NAMES},ORB-ORB-HAM-BF"]
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_what_is_finished_is_not_made_again(
    flight: Path, tmp_path: Path, number: signal.Signals, call: Call
) -> None:
    output = tmp_path / "models"
    process = begin(flight, output)
    wait_until(lambda: process.poll() is not None or len(list(output.glob("*/outcome.json"))) >= 2)
    outcomes = sorted(output.glob("*/outcome.json"))
    children = psutil.Process(process.pid).children(recursive=True)
    process.send_signal(number)
    _, err = process.communicate()
    _, alive = psutil.wait_procs(children, timeout=60)
    assert alive == []
    if number == signal.SIGINT:
        assert process.returncode == 130
        assert err.splitlines()[-1].startswith("interrupted; ")
        assert "Traceback" not in err
    before = {path: path.stat().st_mtime_ns for path in outcomes}
    names = ",".join(path.parent.name for path in outcomes)
    answer = call("reconstruct", flight, "-o", output, "--combinations", names, *OPTIONS)
    assert answer.code == 0
    assert f"{len(outcomes)} of {len(outcomes)} models are already finished\n" in answer.err
    assert {path: path.stat().st_mtime_ns for path in outcomes} == before

    # The same command: what was being made is made, and the rest after it.
    again = begin(flight, output)
    _, err = again.communicate()
    assert again.returncode == 0, err
    assert any(f"{len(outcomes)} of " in line for line in err.splitlines())
    assert {path: path.stat().st_mtime_ns for path in outcomes} == before
    finished = sorted(path.parent.name for path in output.glob("*/outcome.json"))
    written = pl.read_csv(output / "reconstructions.csv")
    assert len(written) == len(finished) > len(outcomes)
