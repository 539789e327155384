"""COLMAP's database: cameras, images, keypoints, matches and verified pairs."""

from __future__ import annotations

import shlex
import shutil
from pathlib import Path

from aerocues.exports.flight import Flight

DATABASE = "database.db"
MODEL = "sparse"


def write_colmap(flight: Flight, folder: Path) -> list[str]:
    """Write ``images/`` and ``database.db``, as `aerocues.reconstruct` gives them to COLMAP.

    Descriptors are not written: COLMAP only knows its own, and needs them only to match.
    """
    flight.move_images(folder)
    shutil.move(flight.database, folder / DATABASE)
    (folder / MODEL).mkdir(exist_ok=True)
    words = ["colmap", "mapper", "--database_path", str(folder / DATABASE)]
    words += ["--image_path", str(folder / "images"), "--output_path", str(folder / MODEL)]
    return [shlex.join(words)]
