"""Images in the folder of models, and the list of them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from aerocues.reconstruction.scene import IMAGES
from aerocues.results.whole_files import json_content, write_whole

LIST = "images.json"


@dataclass(frozen=True)
class Prepared:
    """The size of the measured image, and its focal length in pixels if EXIF has it."""

    name: str
    width: int
    height: int
    focal_length: float | None


def read_prepared(folder: Path, keys: Mapping[str, str]) -> dict[str, Prepared]:
    """The images that are already in the folder of models and unchanged."""
    try:
        stored = json.loads((folder / LIST).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return {
        name: Prepared(**stored[name]["image"])
        for name, key in keys.items()
        if name in stored and stored[name]["key"] == key and (folder / IMAGES / name).is_file()
    }


def write_prepared(folder: Path, keys: Mapping[str, str], prepared: Mapping[str, Prepared]) -> None:
    """Record which images are in the folder; OSError if the disk is full."""
    listed = {name: {"key": keys[name], "image": asdict(each)} for name, each in prepared.items()}
    write_whole({folder / LIST: json_content(listed)})
