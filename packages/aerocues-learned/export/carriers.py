"""Files of weights inside the packages that carry them."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import torch
from torch import Tensor


def carried(package: str, *path: str) -> Path:
    """A file of an installed package, which is not imported: that would need what it depends on."""
    spec = importlib.util.find_spec(package)
    assert spec is not None, f"{package} is not installed"
    assert spec.origin is not None
    return Path(spec.origin).parent.joinpath(*path)


def state(file: Path) -> dict[str, Tensor]:
    """Weights from a file of torch."""
    loaded: dict[str, Tensor] = torch.load(file, map_location="cpu", weights_only=True)
    return loaded
