"""Writes the true poses of a flight in the formats of other programs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import PinholeCamera
from aerocues.datasets.flight_angles import ENU_FROM_NED
from aerocues.simulation.camera import Pose

CSV_HEADER = "image,north,east,down,pitch,yaw,roll,time"


def write_poses(
    folder: Path,
    names: Sequence[str],
    poses: Sequence[Pose],
    times: Sequence[float],
    camera: PinholeCamera,
) -> None:
    """Write all formats into a folder.

    ``poses.csv``: north, east, down in metres, degrees, seconds. ``trajectory.tum``: time, position
    and quaternion (x, y, z, w) from camera to world; images of the same time are numbered one
    second apart, as the format needs ascending times. ``sparse/``: COLMAP's text model without
    points. The last two use east, north, up, because viewers expect z up.
    """
    moments = times if len(set(times)) == len(times) else [float(i) for i in range(len(times))]
    sparse = folder / "sparse"
    sparse.mkdir(parents=True, exist_ok=True)
    rows = [
        f"{name},{p.north!r},{p.east!r},{p.down!r},{p.pitch!r},{p.yaw!r},{p.roll!r},{time!r}"
        for name, p, time in zip(names, poses, times, strict=True)
    ]
    _write(folder / "poses.csv", [CSV_HEADER, *rows])
    _write(folder / "trajectory.tum", [_tum(p, t) for p, t in zip(poses, moments, strict=True)])
    _write(sparse / "cameras.txt", [_camera(camera)])
    images = [_image(number, n, p) for number, (n, p) in enumerate(zip(names, poses, strict=True))]
    _write(sparse / "images.txt", images)
    _write(sparse / "points3D.txt", [])


def _write(path: Path, lines: Sequence[str]) -> None:
    path.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")


def _camera(camera: PinholeCamera) -> str:
    # COLMAP's pixel centres are at 0.5.
    numbers = (camera.focal_x, camera.focal_y, camera.centre_x + 0.5, camera.centre_y + 0.5)
    return f"1 PINHOLE {camera.width} {camera.height} " + " ".join(repr(n) for n in numbers)


def _image(number: int, name: str, pose: Pose) -> str:
    rotation = pose.rotation @ ENU_FROM_NED
    x, y, z, w = _quaternion(rotation)
    shift = -rotation @ (ENU_FROM_NED @ pose.centre)
    numbers = " ".join(repr(float(part)) for part in (w, x, y, z, *shift))
    return f"{number + 1} {numbers} 1 {name}\n"  # an empty line: no points


def _tum(pose: Pose, time: float) -> str:
    centre = ENU_FROM_NED @ pose.centre
    turn = _quaternion((pose.rotation @ ENU_FROM_NED).T)
    return " ".join(f"{float(part):.9f}" for part in (time, *centre, *turn))


def _quaternion(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """x, y, z, w."""
    from scipy.spatial.transform import Rotation

    turn: NDArray[np.float64] = Rotation.from_matrix(rotation).as_quat()
    return turn
