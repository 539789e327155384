"""Reconstructing at equal footing, and within a time."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

import aerocues
from aerocues.datasets.dataset import Dataset
from aerocues.reconstruction.models import Models
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.reconstruct import reconstruct_scene
from tests.made_once import made_once
from tests.reconstruction.scenes import write_scene

SIFT = "SIFT-SIFT-L2-EXACT"


@pytest.fixture(scope="module")
def landscape(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    return made_once(tmp_path_factory, "landscape", write_scene)[1]


def contrast(models: Models) -> float:
    """The threshold of SIFT under which models were made; there need be no model."""
    [row] = models.table().to_dicts()
    return float(json.loads(row["parameters"])["detector"][-1]["contrastThreshold"])


@pytest.mark.slow
def test_thresholds_are_lowered_unless_it_is_told_otherwise(
    landscape: Dataset, tmp_path: Path
) -> None:
    two = replace(landscape, images=landscape.images[:2], pairs=landscape.pairs[:1])
    made = partial(aerocues.reconstruct, two, SIFT, max_keypoints=4000, baseline=False, workers=1)
    usual = contrast(made(output=tmp_path / "plain", equal_footing=False))
    assert contrast(made(output=tmp_path / "equal")) < usual
    assert contrast(made(output=tmp_path / "thesis", preset="thesis")) == usual


@pytest.mark.slow
def test_after_the_deadline_nothing_is_made(landscape: Dataset, tmp_path: Path) -> None:
    options = ReconstructionOptions(workers=1, deadline=0.0)
    models = reconstruct_scene(landscape, SIFT, tmp_path / "models", options)
    assert models.table().is_empty()
