"""`--plugin`: a method of the user's own, in any command that names methods."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import pytest

from aerocues.methods import plugins
from aerocues.results.measured_results import Results
from tests.cli.conftest import Call
from tests.methods.distribution import write_distribution

ROOT_SIFT = """
import cv2
import numpy as np

from aerocues import Features, Keypoints


class SqrtSift:
    dtype = "float32"

    def describe(self, image, keypoints):
        found, descriptors = cv2.SIFT.create().compute(image, keypoints.to_opencv())
        descriptors /= descriptors.sum(axis=1, keepdims=True) + 1e-7
        return Features(Keypoints.from_opencv(found), np.sqrt(descriptors))
"""


@pytest.fixture
def plugin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A plug-in in the folder where the command is called."""
    monkeypatch.setattr(plugins, "_REGISTERED", {})
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.delitem(sys.modules, "own_sift", raising=False)
    monkeypatch.chdir(tmp_path)
    Path("own_sift.py").write_text(ROOT_SIFT)
    return "own_sift:SqrtSift"


def test_it_is_listed_and_explained(call: Call, plugin: str) -> None:
    listed = json.loads(call("methods", "--json", "--plugin", plugin).out)["descriptors"]
    assert listed[-1]["name"] == "SQRTSIFT"
    assert call("methods", "list", "SIFT-SQRTSIFT-*", "--plugin", plugin).out.split() == [
        "SIFT-SQRTSIFT-L2-BF",
        "SIFT-SQRTSIFT-L2-FLANN",
    ]
    assert "runs" in call("methods", "why", "GFTT-SQRTSIFT-L2-BF", "--plugin", plugin).out


def test_workers_measure_it(call: Call, plugin: str, photos: Path, tmp_path: Path) -> None:
    combinations = ("--combinations", "SIFT-SQRTSIFT-L2-BF,SIFT-SIFT-L2-BF", "--timing", "shared")
    output = tmp_path / "results"
    answer = call("run", photos, "-o", output, *combinations, "--plugin", plugin, "--workers", 1)
    assert answer.code == 0, answer.err
    rows = Results(output).table()
    assert rows["status"].to_list() == ["ok"] * 6
    matches = rows.group_by("descriptor").agg("matches").sort("descriptor")
    assert matches["matches"][0].to_list() != matches["matches"][1].to_list()


@pytest.mark.parametrize("plugin_text", ["missing:X", "json:dumps", "nothing"])
def test_what_is_not_a_method_is_told_in_one_line(
    call: Call, plugin: str, plugin_text: str
) -> None:
    answer = call("methods", "--plugin", plugin_text)
    assert (answer.code, answer.err.count("\n")) == (2, 1)
    assert plugin_text in answer.err


def test_plug_ins_of_packages_can_be_left_out(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    offered = {"detectors": {"LOUD": "loud:Anything", "GONE": "gone:Anything"}}
    code = {"loud.py": "print('loud')\n", "gone.py": "import os; os._exit(3)\n"}
    write_distribution(tmp_path, "rogue", offered, code)
    monkeypatch.syspath_prepend(tmp_path)
    answer = call("methods", "--json")
    rows = {row["name"]: row["unavailable"] for row in json.loads(answer.out)["detectors"]}
    assert "'loud'" in rows["LOUD"]
    assert "exit code 3" in rows["GONE"]
    assert (answer.code, answer.err) == (0, "")
    answer = call("methods", "--json", "--no-plugins")
    assert not {"LOUD", "GONE"} & {row["name"] for row in json.loads(answer.out)["detectors"]}
    assert "AEROCUES_PLUGINS" not in os.environ
    monkeypatch.setenv("AEROCUES_PLUGINS", "gone")
    named = {row["name"] for row in json.loads(call("methods", "--json").out)["detectors"]}
    assert named & {"LOUD", "GONE"} == {"GONE"}
