"""Results folders with made-up 3D models: hills with houses under a grid of cameras."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import ArrayLike, NDArray

import aerocues
from aerocues.results.clouds import Cloud
from aerocues.results.store import Store
from tests.report.made_up import COMBINATIONS, folder_of, measured

METHODS = ("detector", "descriptor", "norm", "matcher")
MODELLED = (*COMBINATIONS, "KAZE-KAZE-L2-BF")
STATUSES = ("ok", "ok", "ok", "misplaced", "incomplete", "no_verified_pair")
REASONS = {
    "misplaced": "the cameras are 38.0 m from their true positions: the model is <bent>",
    "incomplete": "the model holds 4 of 12 images",
    "no_verified_pair": "none of 28 pairs has matches that beat chance",
}
IMAGES = 12
# Focal length, width and height of the camera in pixels.
VIEW = (900.0, 1000.0, 665.0)
NADIR = np.diag([1.0, -1.0, -1.0])


def landscape(points: int, seed: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """Points (N, 3) on hills, some of them on houses, and their colours (N, 3)."""
    generator = np.random.default_rng(seed)
    xy = generator.uniform(-100, 100, (points, 2))
    height = 8 * np.sin(xy[:, 0] / 30) * np.cos(xy[:, 1] / 40)
    on_house = np.all(np.abs(xy % 50 - 25) < 8, axis=1)
    colours = np.where(on_house[:, np.newaxis], (170, 80, 60), (90, 130, 70))
    colours = colours + generator.integers(-25, 25, (points, 1))
    return np.column_stack([xy, height + 9 * on_house]), colours.astype(np.uint8)


def cloud_of(
    *, points: int = 300, seed: int = 0, bend: float = 0.0, cameras: int = IMAGES, unit: str = "m"
) -> Cloud:
    """A model of the landscape; `bend` is how far its edges stand too high, in metres."""
    generator = np.random.default_rng(seed + 1)
    xyz, colours = landscape(points, seed)
    columns = -(-cameras // 3)
    grid = np.stack(np.meshgrid(np.linspace(-75, 75, columns), (-60, 0, 60)), axis=-1)
    true = np.column_stack([grid.reshape(-1, 2)[:cameras], np.full(cameras, 90.0)])
    noise = generator.gamma(2, 0.15, points)
    return Cloud(
        points=_floats(_bent(xyz, bend) + generator.normal(0, 0.2, xyz.shape)),
        colours=colours,
        errors=_floats(generator.gamma(4, 0.15, points)),
        track_lengths=generator.integers(2, 9, points).astype(np.int32),
        distances=_floats(noise + bend * (xyz[:, 0] / 100) ** 2),
        centres=_floats(_bent(true, bend) + generator.normal(0, 0.3, true.shape)),
        rotations=_floats(np.broadcast_to(NADIR, (cameras, 3, 3))),
        names=np.array([f"{number:02}.jpg" for number in range(cameras)]),
        positions=_floats(true if unit == "m" else np.full_like(true, np.nan)),
        view=_floats(VIEW),
        unit=unit,
    )


def _floats(values: ArrayLike) -> NDArray[np.float32]:
    return np.array(values, np.float32)


def _bent(xyz: NDArray[Any], bend: float) -> NDArray[Any]:
    risen = xyz.copy()
    risen[:, 2] += bend * (xyz[:, 0] / 100) ** 2
    return risen


def model_row(name: str, status: str, rank: int, cloud: Cloud | None) -> dict[str, Any]:
    """The figures of a reconstruction; the first of all is the reference."""
    row: dict[str, Any] = {
        "dataset": "flight",
        **dict(zip(METHODS, name.split("-"), strict=True)),
        "status": status,
        "message": REASONS.get(status),
        "images": IMAGES,
        "pairs": 28,
        "row_key": f"{rank:032x}",
        "reconstruction_seconds": 20.0 + 7 * rank,
    }
    if cloud is None:
        return row
    off = np.linalg.norm(cloud.centres - cloud.positions, axis=1)
    figures = {
        "registered_images": len(cloud.centres),
        "components": 1,
        "points_3d": 12000 - 1500 * rank,
        "observations": 50000 - 5000 * rank,
        "mean_track_length": 4.2 - 0.1 * rank,
        "reprojection_error": 0.6 + 0.05 * rank,
        "reference": MODELLED[0],
        "length_unit": cloud.unit,
    }
    if cloud.unit == "m":
        rmse = float(np.sqrt((off**2).mean()))
        figures |= {"position_rmse": rmse, "position_error_share": rmse / 230, "truth": "gps"}
    for way, factor in (("cloud", 1.0), ("reference", 1.6)):
        of = cloud.distances * factor * (rank > 0)
        figures |= {
            f"{way}_distance_median": float(np.median(of)),
            f"{way}_distance_rms": float(np.sqrt((of**2).mean())),
            f"{way}_distance_p95": float(np.percentile(of, 95)),
        }
    return row | figures


def made_models(
    names: tuple[str, ...] = MODELLED, points: int = 300, unit: str = "m"
) -> tuple[pl.DataFrame, dict[str, Cloud]]:
    """Rows of reconstructions and clouds by the key of the row; `STATUSES` in turn."""
    rows, clouds = [], {}
    for rank, name in enumerate(names):
        status = STATUSES[rank % len(STATUSES)]
        cloud = None
        if status in ("ok", "misplaced", "incomplete"):
            cloud = cloud_of(
                points=points,
                seed=rank,
                bend=40.0 if status == "misplaced" else 0.0,
                cameras=4 if status == "incomplete" else IMAGES - (rank > 0),
                unit=unit,
            )
        rows.append(model_row(name, status, rank, cloud))
        if cloud is not None:
            clouds[rows[-1]["row_key"]] = cloud
    return pl.DataFrame(rows, infer_schema_length=None), clouds


def with_models(
    folder: Path, names: tuple[str, ...] = MODELLED, points: int = 300, unit: str = "m"
) -> aerocues.Results:
    """Results of these combinations with a reconstruction of each."""
    results = folder_of(measured(combinations=names), folder)
    rows, clouds = made_models(names, points, unit)
    store = Store.open(results.folder)
    store.write_reconstructions(rows)
    for key, cloud in clouds.items():
        store.write_cloud(key, cloud)
    return results
