"""Fixtures of the tests of aerocues-learned."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from aerocues import Features

FOLDER = Path(__file__).resolve().parent
Golden = dict[str, NDArray[np.generic]]


@pytest.fixture(scope="session", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Keep what is remembered of plug-ins out of the home of whoever runs the tests."""
    os.environ["AEROCUES_CACHE"] = str(tmp_path_factory.mktemp("cache"))


@pytest.fixture(scope="session")
def golden() -> Golden:
    """Two images and what torch finds in them: see export/golden.py."""
    with np.load(FOLDER / "golden.npz") as file:
        return dict(file)


@pytest.fixture(scope="session")
def images(golden: Golden) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Two (H, W, 3) views of one texture."""
    return golden["image_1"].astype(np.uint8), golden["image_2"].astype(np.uint8)


@pytest.fixture(scope="session")
def features(images: tuple[NDArray[np.uint8], NDArray[np.uint8]]) -> dict[str, list[Features]]:
    """Features of both images by each extractor, as many as torch was asked for."""
    from aerocues_learned import extractors

    made = {}
    for name, kind, threshold in (
        ("xfeat", extractors.XFeat, 0.05),
        ("aliked-t16", extractors.AlikedT16, 0.0),
        ("aliked-n16rot", extractors.AlikedN16Rot, 0.0),
    ):
        extractor = kind(**{**kind.parameters, "count": 300, "threshold": threshold})
        made[name] = [extractor.extract(image) for image in images]
    return made
