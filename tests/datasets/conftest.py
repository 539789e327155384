from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray


@pytest.fixture
def picture() -> NDArray[np.uint8]:
    """A small smooth BGR picture without symmetry: (60, 80, 3)."""
    noise = np.random.default_rng(3).integers(0, 256, (60, 80, 3)).astype(np.uint8)
    smooth = np.asarray(cv2.GaussianBlur(noise, (0, 0), 3), dtype=np.float32)
    smooth = (smooth - smooth.min()) * (254.0 / float(np.ptp(smooth)))
    smooth[:20, :30, 0] = 255
    picture: NDArray[np.uint8] = smooth.astype(np.uint8)
    return picture


@pytest.fixture
def image_folder(tmp_path: Path, picture: NDArray[np.uint8]) -> Path:
    """A folder with img1, img2, img10 and things that are no images."""
    folder = tmp_path / "scene"
    folder.mkdir()
    for name in ("img10.png", "img2.png", "img1.JPG"):
        cv2.imwrite(str(folder / name), picture)
    (folder / "notes.txt").write_text("no image")
    (folder / "._img1.JPG").write_bytes(b"resource fork")
    (folder / "more.jpg").mkdir()
    return folder
