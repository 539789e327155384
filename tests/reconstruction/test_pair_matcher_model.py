"""A user's pair matcher makes a model with tracks over several images, and a page of it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import aerocues
from aerocues.methods import plugins
from tests.reconstruction.scenes import Options, write_scene


@pytest.mark.slow
def test_a_model_of_merged_keypoints(
    tmp_path: Path, quick: Options, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plugins, "_REGISTERED", {})
    aerocues.register("pair_matcher", "FOLLOW", "tests.methods.following:Follow")
    scene = write_scene(tmp_path / "scene", [(-6, 0), (0, 0), (6, 0), (0, 6)])
    results = aerocues.run(scene, "FOLLOW", tmp_path / "results", timing="shared", workers=1)
    models = aerocues.reconstruct(
        scene, "FOLLOW", tmp_path / "models", results=results, workers=1, **quick
    )
    [row] = models.table().to_dicts()
    assert (row["status"], row["registered_images"]) == ("ok", 4)
    assert row["mean_track_length"] > 2.2
    assert (row["feature_seconds"], row["matching_seconds"] > 0) == (0, True)
    assert json.loads(row["parameters"])["merged_within"] == 1.0
    page = aerocues.write_report(results, tmp_path / "report.html")
    assert "FOLLOW-NONE-NONE-FOLLOW" in page.read_text(encoding="utf-8")
