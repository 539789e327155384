"""Differences between versions of pycolmap. It can abort: import it only in a child process."""

from __future__ import annotations

from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ReconstructionError

Array = NDArray[np.float64]
UPGRADE = "install a newer one: pip install --upgrade pycolmap"


def colmap_version() -> str:
    """The version of pycolmap, without importing it.

    Raises
    ------
    ReconstructionError
        If pycolmap is not installed, as in the light install for boards.
    """
    if find_spec("pycolmap") is None:
        raise ReconstructionError(
            "3D models need pycolmap, which is not installed; install it with: pip install "
            "pycolmap, "
            "or move the results to a machine that has it (aerocues results --pack)"
        )
    return version("pycolmap")


def quiet() -> None:
    """Limit COLMAP's log to fatal errors."""
    import pycolmap

    pycolmap.logging.minloglevel = 2
    pycolmap.logging.stderrthreshold = 2


def open_database(file: Path) -> Any:
    """A database; it is created if it does not exist."""
    import pycolmap

    opened = getattr(pycolmap.Database, "open", None)
    if opened is not None and major_minor() >= (3, 13):
        return opened(file)
    older: Any = pycolmap.Database
    return older(str(file))


def major_minor() -> tuple[int, int]:
    """Its version as numbers that compare."""
    major, minor = colmap_version().split(".")[:2]
    return int(major), int(minor)


def require(name: str, purpose: str) -> Any:
    """A function of pycolmap; ReconstructionError if this version lacks it."""
    import pycolmap

    found = getattr(pycolmap, name, None)
    if found is None:
        raise ReconstructionError(
            f"pycolmap {pycolmap.__version__} has no {name}, which {purpose} needs; {UPGRADE}"
        )
    return found


def image_pair(pair_id: Any) -> tuple[int, int]:
    """COLMAP's IDs of the two images of a pair."""
    import pycolmap

    owner: Any = pycolmap if hasattr(pycolmap, "pair_id_to_image_pair") else pycolmap.Database
    first, second = owner.pair_id_to_image_pair(pair_id)
    return int(first), int(second)


def registered(model: Any) -> list[Any]:
    """The registered images of a model, by name."""
    images = [image for image in model.images.values() if image.has_pose]
    return sorted(images, key=lambda image: str(image.name))


def camera_from_world(image: Any) -> tuple[Array, Array]:
    """Rotation (3, 3) and translation (3,) from the frame of the model to the camera."""
    pose = image.cam_from_world
    matrix = np.asarray((pose() if callable(pose) else pose).matrix(), np.float64)
    return matrix[:, :3], matrix[:, 3]
