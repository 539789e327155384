"""Models and clouds as the page has them, small and with names that try to break out."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

STATUSES = ("ok", "ok", "ok", "misplaced", "incomplete", "no_verified_pair")
FEATURES = ("inliers", "precision")
OUTCOMES = ("registered_images", "points_3d")
REFERENCE = "SIFT-SIFT-L2-BF"
CLOUDS = (REFERENCE, "SIFT-SIFT-L2-FLANN", "ORB-ORB-HAM-BF")


def small_models(methods: tuple[tuple[str, ...], ...], harmful: str) -> dict[str, Any]:
    """One reconstruction a combination; `STATUSES` in turn."""
    count = len(methods)
    generator = np.random.default_rng(0)
    status = [STATUSES[i % len(STATUSES)] for i in range(count)]
    lost = [each == "no_verified_pair" for each in status]

    def known(values: ArrayLike) -> list[float | None]:
        listed = np.asarray(values).tolist()
        return [None if gone else value for gone, value in zip(lost, listed, strict=True)]

    columns: dict[str, tuple[str, str | None, list[Any]]] = {
        "images": ("count", None, [12] * count),
        "registered_images": ("count", "higher", known(np.maximum(12 - np.arange(count), 2))),
        "points_3d": ("count", "higher", known(5000 - 300 * np.arange(count))),
        "reprojection_error": ("px", "lower", known(0.5 + 0.03 * np.arange(count))),
        "position_rmse": ("m", "lower", known(generator.uniform(0.5, 40, count))),
        **{
            f"{way}_distance_{statistic}": ("m", "lower", known(factor * np.arange(count) / 9))
            for way in ("cloud", "reference")
            for factor, statistic in ((1, "median"), (2, "rms"), (4, "p95"))
        },
    }
    matrix = [[0.7, -0.2], [0.9, 0.4]]
    return {
        "combinations": ["-".join(method) for method in methods],
        **{
            name: [method[i] for method in methods]
            for i, name in enumerate(("detector", "descriptor", "norm", "matcher"))
        },
        "status": status,
        "message": [None if each == "ok" else f"it {each} {harmful}" for each in status],
        "columns": [
            {"name": name, "unit": unit, "better": better, "definition": f"{name} {harmful}"}
            for name, (unit, better, _) in columns.items()
        ],
        "values": {name: values for name, (_, _, values) in columns.items()},
        "reference": REFERENCE,
        "baseline": None,
        "statuses": {"ok": "it held"},
        "made": {"mapper": "incremental", "pairing": harmful},
        "relations": {
            "combinations": ["-".join(method) for method in methods],
            "features": list(FEATURES),
            "outcomes": list(OUTCOMES),
            "values": {
                **{name: generator.uniform(0.1, 1, count).tolist() for name in FEATURES},
                "registered_images": [value or 0 for value in columns["registered_images"][2]],
                "points_3d": [
                    value if each == "ok" else None
                    for value, each in zip(columns["points_3d"][2], status, strict=True)
                ],
            },
            "pearson": matrix,
            "spearman": matrix,
            "numbers": [[count, count - 2], [count, count - 2]],
            "fewest": 5,
        },
    }


def small_clouds(entry: str) -> list[dict[str, Any]]:
    """A few clouds of an entry: a plane below a row of cameras."""
    return [_cloud(entry, name, seed) for seed, name in enumerate(CLOUDS)]


def _floats(values: ArrayLike) -> dict[str, str]:
    return {"f32": base64.b64encode(np.asarray(values, "<f4").tobytes()).decode()}


def _cloud(entry: str, name: str, seed: int) -> dict[str, Any]:
    generator = np.random.default_rng(seed)
    count, cameras = 200, 5
    centres = np.column_stack([np.linspace(-8, 8, cameras), np.zeros(cameras), np.full(cameras, 9)])
    colours = generator.integers(60, 200, (count, 3)).astype(np.uint8)
    return {
        "entry": entry,
        "combination": name,
        "why": "best by CUES",
        "unit": "m",
        "all_points": count + 50,
        "strays": 1,
        "points": _floats(generator.uniform(-10, 10, (count, 3)) * (1, 1, 0.1)),
        "colours": {"u8": base64.b64encode(colours.tobytes()).decode()},
        "errors": _floats(generator.uniform(0, 2, count)),
        "track_lengths": {"u8": base64.b64encode(bytes([3] * count)).decode()},
        "distances": _floats(generator.uniform(0, 1, count)),
        "centres": _floats(centres),
        "rotations": _floats(np.broadcast_to(np.diag([1, -1, -1]), (cameras, 3, 3))),
        "positions": _floats(centres + 0.5),
        "names": [f"{place}.png" for place in range(len(centres))],
        "view": [900.0, 1000.0, 665.0],
    }
