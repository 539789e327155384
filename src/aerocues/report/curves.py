"""Graded transformations: pairs that form a curve, and the name of its axis."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

Pair = Mapping[str, Any]
# Names and axes of the transformations in `datasets.synthetic`.
AXES: dict[str, tuple[str, str]] = {
    "rotation": ("rotation", "degrees"),
    "scale": ("scale", "factor"),
    "intensity_add": ("intensity added", "gray levels"),
    "intensity_mul": ("intensity multiplied", "factor"),
    "contrast": ("contrast", "factor"),
    "noise": ("noise", "gray levels"),
    "blur": ("blur", "sigma in px"),
    "jpeg": ("JPEG compression", "quality"),
    "tilt": ("tilt", "degrees"),
}
# The transformations of the sequences of Mikolajczyk et al. (IJCV 2005), in their words.
OXFORD = {
    "bark": "zoom and rotation",
    "bikes": "blur",
    "boat": "zoom and rotation",
    "graf": "viewpoint",
    "leuven": "light",
    "trees": "blur",
    "ubc": "JPEG compression",
    "wall": "viewpoint",
}
HPATCHES = {"i_": "illumination", "v_": "viewpoint"}
NUMBER = re.compile(r"(\d+)\.\w+$")


def step_of(dataset: str, pair: Pair) -> float | None:
    """Position of a pair along its curve; None if it is not on a curve."""
    if dataset.startswith("synthetic"):
        return _transformation(pair)[1]
    if dataset in ("oxford", "hpatches") and pair["sequence"]:
        found = NUMBER.search(pair["image_2"])
        return float(found[1]) if found else None
    return None


def _transformation(pair: Pair) -> tuple[str, float | None]:
    from aerocues.datasets.synthetic import EXTENDED

    for row in EXTENDED:
        if row.name == pair["image_2"]:
            return row.kind, row.value
    return "", None


def _curve_of(dataset: str, pair: Pair) -> tuple[str, str]:
    """Name and axis of the curve of a pair."""
    if dataset.startswith("synthetic"):
        return AXES.get(_transformation(pair)[0], ("", ""))
    sequence = pair["sequence"]
    changes = OXFORD.get(sequence) if dataset == "oxford" else HPATCHES.get(sequence[:2])
    return sequence, f"image ({changes})" if changes else "image"


def curves_of(dataset: str, pairs: Sequence[Pair]) -> list[dict[str, Any]]:
    """Curves with at least two pairs, sorted along their axis.

    Parameters
    ----------
    dataset : str
    pairs : sequence of mapping
        With ``sequence``, ``image_2``, and ``step`` from `step_of`.
    """
    members: dict[tuple[str, str], list[int]] = {}
    for position, pair in enumerate(pairs):
        if pair["step"] is not None:
            members.setdefault(_curve_of(dataset, pair), []).append(position)
    curves = []
    for (name, axis), positions in members.items():
        along = sorted(positions, key=lambda position: pairs[position]["step"])
        steps = [pairs[position]["step"] for position in along]
        if name and len(set(steps)) > 1:
            curves.append({"name": name, "axis": axis, "pairs": along, "x": steps})
    return curves
