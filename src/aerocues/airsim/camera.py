"""The camera of a simulator in ComputerVision mode: placed, then asked for colour and depth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.airsim.connection import Connection, RefusedCallError, as_bytes
from aerocues.errors import SimulationError
from aerocues.simulation.camera import Pose

FLAVOURS = ("airsim", "cosys")
POSITION_TOLERANCE = 0.01
"""Metres that the reported position may differ from the one asked for."""

ANGLE_TOLERANCE = 0.05
"""Degrees that the reported orientation may differ from the one asked for."""

_CAMERA = "0"
_SCENE, _DEPTH_PLANAR = 0, 1
_SKY = 65000.0
"""Depth in metres from which on there is nothing: the largest number that half precision has."""

_ATTEMPTS = 3


@dataclass(frozen=True, eq=False)
class Photograph:
    """What the simulator's camera saw.

    Parameters
    ----------
    rgb : (H, W, 3) uint8
    depth : (H, W) float32
        Planar, metres; infinite in the sky.
    """

    rgb: NDArray[np.uint8]
    depth: NDArray[np.float32]


class SimulatorCamera:
    """Camera "0" of the simulator's default vehicle.

    Parameters
    ----------
    connection : Connection
    flavour : {"airsim", "cosys"} or None
        AirSim 1.8.1 takes one more argument than Cosys-AirSim; None: find out.
    fov : float
        Horizontal field of view, degrees.

    Raises
    ------
    SimulationError
        If the simulator refuses, or keeps another field of view.
    """

    def __init__(self, connection: Connection, flavour: str | None, fov: float) -> None:
        self._connection = connection
        self.flavour = flavour or self._find_flavour()
        self.server_version = int(connection.call("getServerVersion"))
        self._call("simSetCameraFov", _CAMERA, fov)
        self._call("simSetCameraPose", _CAMERA, _pose((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)))
        found = float(self._call("simGetCameraInfo", _CAMERA)["fov"])
        if abs(found - fov) > 1e-3:
            raise SimulationError(
                f"the simulator's camera has a field of view of {found:g} degrees and not {fov:g}; "
                f'set "FOV_Degrees": {fov:g} in the CaptureSettings of its settings.json'
            )
        # The world stands still: cars and leaves are where they were in the image before.
        connection.call("simPause", True)

    def _find_flavour(self) -> str:
        try:
            self._connection.call("simGetCameraInfo", _CAMERA, "", False)
        except RefusedCallError as refusal:
            if "number of arguments" not in str(refusal):
                raise
            return "cosys"
        return "airsim"

    def _call(self, method: str, *arguments: Any) -> Any:
        """Call a method of the camera; the name of the vehicle, and what AirSim adds, go last."""
        last = ("", False) if self.flavour == "airsim" else ("",)
        try:
            return self._connection.call(method, *arguments, *last)
        except RefusedCallError as refusal:
            if "number of arguments" not in str(refusal):
                raise
            other = next(flavour for flavour in FLAVOURS if flavour != self.flavour)
            raise SimulationError(
                f'{refusal}; the simulator is not {self.flavour}: use `flavour="{other}"`'
            ) from refusal

    def release(self) -> None:
        """Let the world go on."""
        self._connection.call("simPause", False)

    def take(self, pose: Pose) -> Photograph:
        """Place the camera and take colour and depth with one request.

        Raises
        ------
        SimulationError
            If the camera does not go where it is told, or the images are not as asked for.
        """
        turn = _quaternion(pose)
        wanted = _pose((pose.north, pose.east, pose.down), turn)
        off = ""
        for _ in range(_ATTEMPTS):
            self._connection.call("simSetVehiclePose", wanted, True, "")
            colour, depth = self._images()
            off = _difference(colour, pose, turn) or _difference(depth, pose, turn)
            if not off:
                return Photograph(_colour(colour), _depth(depth))
        raise SimulationError(
            f"the camera is not where it was told to be: {off}; run the simulator in "
            'ComputerVision mode ("SimMode": "ComputerVision" in its settings.json)'
        )

    def _images(self) -> tuple[Any, Any]:
        requests = [
            {
                "camera_name": _CAMERA,
                "image_type": kind,
                "pixels_as_float": kind == _DEPTH_PLANAR,
                # As PNG, colours are lossless and their order is not in doubt.
                "compress": kind == _SCENE,
                **({"annotation_name": ""} if self.flavour == "cosys" else {}),
            }
            for kind in (_SCENE, _DEPTH_PLANAR)
        ]
        answers = self._call("simGetImages", requests)
        if len(answers) != 2:
            raise SimulationError(
                f"the simulator sent {len(answers)} images in place of 2; see its log"
            )
        return answers[0], answers[1]


def _pose(position: tuple[float, ...], turn: tuple[float, ...]) -> dict[str, dict[str, float]]:
    w, x, y, z = turn
    return {
        "position": dict(zip(("x_val", "y_val", "z_val"), position, strict=True)),
        "orientation": {"w_val": w, "x_val": x, "y_val": y, "z_val": z},
    }


def _quaternion(pose: Pose) -> tuple[float, float, float, float]:
    """w, x, y, z of the turn from the camera's body (forward, right, down) to north, east, down."""
    from scipy.spatial.transform import Rotation

    angles = (pose.yaw, pose.pitch, pose.roll)
    x, y, z, w = Rotation.from_euler("ZYX", angles, degrees=True).as_quat().tolist()
    return w, x, y, z


def _difference(answer: Any, pose: Pose, turn: tuple[float, ...]) -> str:
    """How an image's pose differs from the one asked for, in words; empty where it does not."""
    position = np.array([answer["camera_position"][axis] for axis in ("x_val", "y_val", "z_val")])
    found = answer["camera_orientation"]
    quaternion = np.array([found[part] for part in ("w_val", "x_val", "y_val", "z_val")])
    distance = float(np.linalg.norm(position - pose.centre))
    cosine = abs(float(quaternion @ np.array(turn))) / max(float(np.linalg.norm(quaternion)), 1e-9)
    angle = float(np.degrees(2 * np.arccos(min(cosine, 1.0))))
    if distance <= POSITION_TOLERANCE and angle <= ANGLE_TOLERANCE:
        return ""
    return f"{distance:.3g} m and {angle:.3g} degrees off"


def _colour(answer: Any) -> NDArray[np.uint8]:
    import cv2

    data = np.frombuffer(as_bytes(answer["image_data_uint8"]), np.uint8)
    decoded = cv2.imdecode(data, cv2.IMREAD_COLOR) if len(data) > 1 else None
    if decoded is None:
        raise SimulationError("the simulator sent no colours; see its log")
    return np.asarray(cv2.cvtColor(decoded, cv2.COLOR_BGR2RGB), np.uint8)


def _depth(answer: Any) -> NDArray[np.float32]:
    values = np.asarray(answer["image_data_float"], np.float32)
    height, width = int(answer["height"]), int(answer["width"])
    if values.size != height * width or not values.size:
        raise SimulationError(
            f"the simulator sent {values.size} depths for {width} x {height} pixels; see its log"
        )
    values[values >= _SKY] = np.inf
    return values.reshape(height, width)
