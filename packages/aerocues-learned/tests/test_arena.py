"""Learned methods in aerocues: measured as the others are, the same every time."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import polars as pl
import pytest
from aerocues_learned.weights import VARIABLE
from numpy.typing import NDArray

import aerocues
from aerocues.errors import SelectionError
from aerocues.methods.plugins import installed_methods
from aerocues.methods.selection import select
from aerocues.methods.strongest import KeypointLimit

REPOSITORY = Path(__file__).resolve().parents[3]
LIGHTERGLUE = "XFEAT-XFEAT-L2-LIGHTERGLUE"
COMBINATIONS = f"XFEAT-XFEAT-L2-BF,{LIGHTERGLUE},ALIKED_T16-ALIKED_T16-L2-BF"
OF_THE_CLOCK = ("seconds", "cpu", "wall", "memory", "time", "measured", "run")


@pytest.fixture(scope="module")
def photographs(
    images: tuple[NDArray[np.uint8], NDArray[np.uint8]], tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """The two images as files."""
    folder = tmp_path_factory.mktemp("photographs")
    for number, image in enumerate(images, 1):
        assert cv2.imwrite(str(folder / f"{number}.png"), image)
    return folder


def measured(photographs: Path, output: Path, workers: int) -> pl.DataFrame:
    """The rows of a run, without what depends on the clock."""
    results = aerocues.run(
        photographs, COMBINATIONS, output, timing="shared", workers=workers, max_keypoints=500
    )
    rows = results.table().sort("detector", "matcher")
    return rows.drop([name for name in rows.columns if any(part in name for part in OF_THE_CLOCK)])


@pytest.mark.slow
def test_rows_are_the_same_again_and_with_two_workers(photographs: Path, tmp_path: Path) -> None:
    alone = measured(photographs, tmp_path / "alone", 1)
    beside = measured(photographs, tmp_path / "beside", 2)
    assert set(alone["status"]) == {"ok"}
    assert alone.equals(beside)


def test_learned_features_link_two_views(
    images: tuple[NDArray[np.uint8], NDArray[np.uint8]],
) -> None:
    matched = aerocues.match(images[0], images[1], LIGHTERGLUE, max_keypoints=500)
    assert matched.inliers.sum() > 100


def test_a_network_is_loaded_only_when_it_is_used() -> None:
    code = "import aerocues_learned.extractors, aerocues_learned.matchers, sys; print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert {"onnxruntime", "torch", "polars", "pycolmap"} & set(run.stdout.split()) == set()


def test_torch_is_not_needed() -> None:
    assert importlib.util.find_spec("torch") is None


def test_lightglue_without_weights_is_refused_before_anything_is_measured(
    photographs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "none.onnx"))
    with pytest.raises(SelectionError, match=r"none\.onnx does not exist.*make learned-weights"):
        aerocues.run(photographs, "ALIKED_N16ROT-*-LIGHTGLUE", tmp_path / "results")
    assert not (tmp_path / "results").exists()


def test_networks_describe_no_more_than_the_keypoints_that_are_kept() -> None:
    kept = KeypointLimit(500).limited(installed_methods())
    extractors = ("XFEAT", "ALIKED_T16", "ALIKED_N16ROT")
    assert {kept.detectors[name].parameters["count"] for name in extractors} == {500}


def test_the_command_line_knows_them() -> None:
    asked = ["-m", "aerocues", "methods", "why", LIGHTERGLUE, "ALIKED_N16ROT-ALIKED_N16ROT-L2-BF"]
    run = subprocess.run([sys.executable, *asked], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert run.stdout.count(" runs") == 2


def test_combinations_of_the_guide_exist(monkeypatch: pytest.MonkeyPatch) -> None:
    page = (REPOSITORY / "docs" / "learned.md").read_text(encoding="utf-8")
    patterns = re.findall(r"--combinations '([^']+)'", page)
    assert patterns
    # The choice is looked at, not made: a file is enough that is there.
    monkeypatch.setenv(VARIABLE, __file__)
    for each in patterns:
        assert select(installed_methods(), each)
