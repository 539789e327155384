"""The folder of a simulated flight: existing images, and removal of outdated ones."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import SimulationError

TRUTH = "truth"
KEYS = "keys.json"


class FlightFolder:
    """Images and depth maps by name, each with the key of its settings.

    Parameters
    ----------
    folder : Path

    Raises
    ------
    SimulationError
        If the folder is a file or has other files.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.truth = folder / TRUTH
        self._file = self.truth / KEYS
        if folder.exists() and not folder.is_dir():
            raise SimulationError(f"{folder} is a file; give the name of a folder as `output`")
        if folder.is_dir() and not self._file.is_file():
            others = [path.name for path in folder.iterdir() if path.name != TRUTH]
            if others:
                raise SimulationError(
                    f"{folder} holds other files ({others[0]}, ...); give a new or empty folder as "
                    "`output`"
                )
        self._keys: dict[str, str] = {}
        if self._file.is_file():
            self._keys = json.loads(self._file.read_text(encoding="utf-8"))

    def keep(self, keys: Mapping[str, str]) -> None:
        """Remove every outdated image; called before new poses are written.

        Parameters
        ----------
        keys : mapping of str to str
            Keys of all images of the flight, by name.
        """
        self.truth.mkdir(parents=True, exist_ok=True)
        for name in [name for name, key in self._keys.items() if keys.get(name) != key]:
            self.image(name).unlink(missing_ok=True)
            self.depth(name).unlink(missing_ok=True)
            del self._keys[name]
        write_json(self._file, self._keys)

    def has(self, name: str) -> bool:
        """Whether an image and its depth exist."""
        return name in self._keys and self.image(name).is_file() and self.depth(name).is_file()

    def add(self, name: str, key: str) -> None:
        """Record an image; called after its files are written."""
        self._keys[name] = key
        write_json(self._file, self._keys)

    def image(self, name: str) -> Path:
        """The file of an image."""
        return self.folder / name

    def depth(self, name: str) -> Path:
        """The file of its depth."""
        return self.truth / "depth" / Path(name).with_suffix(".npy")


def write_json(path: Path, content: object) -> None:
    """Write JSON to a temporary file and rename it."""
    part = path.with_suffix(".part")
    part.write_text(json.dumps(content, indent=1), encoding="utf-8")
    part.replace(path)


def write_depth(path: Path, depth: NDArray[np.float32]) -> None:
    """Write an array to a temporary file and rename it."""
    part = path.with_suffix(".part")
    with part.open("wb") as file:
        np.save(file, depth)
    part.replace(path)
