"""Writes models in the formats of other programs."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

MODEL = "sparse"
TEXT = "text"
PLY = "points.ply"
UNDISTORTED = "undistorted"


def export_model(model: Any, folder: Path) -> None:
    """Write COLMAP's binary and text formats, and a point cloud as PLY."""
    for name in (MODEL, TEXT, UNDISTORTED):
        shutil.rmtree(folder / name, ignore_errors=True)
    binary = folder / MODEL / "0"
    binary.mkdir(parents=True)
    model.write_binary(str(binary))
    (folder / TEXT).mkdir()
    model.write_text(str(folder / TEXT))
    model.export_PLY(str(folder / PLY))


def undistort(folder: Path, images: Path) -> None:
    """Write undistorted images and their model, for dense reconstruction."""
    import pycolmap

    pycolmap.undistort_images(folder / UNDISTORTED, folder / MODEL / "0", images)
