"""A simulator to test against: AirSim's protocol over a real socket, with a scene to look at."""

from __future__ import annotations

import socketserver
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import cv2
import msgpack
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from aerocues.simulation.camera import Pose, pinhole
from aerocues.simulation.rendering import Rendering

Look = Callable[[Pose, int, int, float], tuple[NDArray[np.uint8], NDArray[np.float32]]]

# Arguments that each server wants; AirSim 1.8.1 has `external` where Cosys-AirSim has none.
COMMON = {"ping": 0, "getServerVersion": 0, "getMinRequiredClientVersion": 0, "simPause": 1}
ARITIES = {
    "airsim": {
        **COMMON,
        "simSetVehiclePose": 3,
        "simSetCameraPose": 4,
        "simSetCameraFov": 4,
        "simGetCameraInfo": 3,
        "simGetImages": 3,
    },
    "cosys": {
        **COMMON,
        "simSetVehiclePose": 3,
        "simSetCameraPose": 3,
        "simSetCameraFov": 3,
        "simGetCameraInfo": 2,
        "simGetImages": 2,
    },
}


def plain(
    pose: Pose, width: int, height: int, fov: float
) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Level ground with a pattern that tells where it is; sky above."""
    camera = pinhole(width, height, fov)
    columns, rows = np.meshgrid(np.arange(width), np.arange(height))
    x, y = (columns - camera.centre_x) / camera.focal_x, (rows - camera.centre_y) / camera.focal_y
    rays = np.stack([x, y, np.ones_like(x)], -1) @ pose.rotation
    with np.errstate(divide="ignore"):
        depth = np.where(rays[..., 2] > 1e-6, -pose.down / rays[..., 2], np.inf)
    finite = np.where(np.isfinite(depth), depth, 0.0)
    ground = finite[..., None] * rays[..., :2] + np.array([pose.north, pose.east])
    red, green = (np.rint(ground.T * 3).astype(np.int64) % 200).astype(np.uint8).swapaxes(1, 2)
    rgb = np.stack([red, green, np.full_like(red, 50)], -1)
    return rgb, depth.astype(np.float32)


def of_rendering(see: Callable[[Pose], tuple[NDArray[np.uint8], Rendering]]) -> Look:
    """What a renderer sees, whatever size is asked for."""

    def look(
        pose: Pose, width: int, height: int, fov: float
    ) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        rgb, rendering = see(pose)
        return rgb, rendering.depth

    return look


@dataclass
class Simulator:
    """The state of a simulator, and the faults that a test provokes.

    ``drop_after`` counts images until the connection breaks, once; ``stuck`` keeps the camera
    where it is; ``gone`` refuses new connections.
    """

    flavour: str = "airsim"
    look: Look = plain
    width: int = 60
    height: int = 40
    fov: float = 70.0
    fixed_fov: bool = False
    drop_after: int | None = None
    stuck: bool = False
    gone: bool = False
    paused: bool = False
    calls: list[str] = field(default_factory=list)
    photographs: int = 0
    pose: dict[str, Any] = field(
        default_factory=lambda: {
            "position": {"x_val": 0.0, "y_val": 0.0, "z_val": 0.0},
            "orientation": {"w_val": 1.0, "x_val": 0.0, "y_val": 0.0, "z_val": 0.0},
        }
    )

    def answer(self, method: str, arguments: list[Any]) -> Any:
        """The result of a call; ValueError for what the server refuses."""
        self.calls.append(method)
        wanted = ARITIES[self.flavour].get(method)
        if wanted is None:
            raise ValueError(f"Function '{method}' could not be found")
        if len(arguments) != wanted:
            raise ValueError(
                f"Function '{method}' was called with an invalid number of arguments. "
                f"Expected: {wanted}, got: {len(arguments)}"
            )
        return getattr(self, f"_{method}")(*arguments[:3])

    def _ping(self) -> bool:
        return True

    def _getServerVersion(self) -> int:  # noqa: N802
        return 1 if self.flavour == "airsim" else 4

    _getMinRequiredClientVersion = _getServerVersion  # noqa: N815

    def _simPause(self, paused: bool) -> None:  # noqa: N802
        self.paused = paused

    def _simSetVehiclePose(self, pose: Any, *_: Any) -> None:  # noqa: N802
        if not self.stuck:
            self.pose = pose

    def _simSetCameraPose(self, *_: Any) -> None:  # noqa: N802
        return None

    def _simSetCameraFov(self, camera: str, fov: float, *_: Any) -> None:  # noqa: N802
        if not self.fixed_fov:
            self.fov = fov

    def _simGetCameraInfo(self, *_: Any) -> dict[str, Any]:  # noqa: N802
        return {"pose": self.pose, "fov": self.fov, "proj_mat": {"matrix": [[0.0] * 4] * 4}}

    def _simGetImages(self, requests: list[Any], *_: Any) -> list[Any]:  # noqa: N802
        if self.drop_after is not None and self.photographs >= self.drop_after:
            self.drop_after = None
            raise ConnectionAbortedError
        self.photographs += 1
        rgb, depth = self.look(self._pose(), self.width, self.height, self.fov)
        return [self._image(request, rgb, depth) for request in requests]

    def _pose(self) -> Pose:
        position, turn = self.pose["position"], self.pose["orientation"]
        w, x, y, z = (turn[part] for part in ("w_val", "x_val", "y_val", "z_val"))
        matrix = Rotation.from_quat([x, y, z, w]).as_matrix()
        # Beyond the nadir the angles of a pose are not unique, so the matrix is taken as it is.
        north, east, down = (position[axis] for axis in ("x_val", "y_val", "z_val"))
        return _Turned(north, east, down, 0.0, 0.0, turn=matrix)

    def _image(
        self, request: Any, rgb: NDArray[np.uint8], depth: NDArray[np.float32]
    ) -> dict[str, Any]:
        if self.flavour == "cosys":
            assert request["annotation_name"] == ""
        is_depth = request["image_type"] == 1
        assert request["pixels_as_float"] == is_depth
        png = cv2.imencode(".png", rgb[..., ::-1])[1].tobytes()
        far = np.minimum(depth, 65504.0).ravel().tolist()
        return {
            "image_data_uint8": b"\0" if is_depth else png,
            "image_data_float": far if is_depth else [0.0],
            "camera_position": self.pose["position"],
            "camera_orientation": self.pose["orientation"],
            "time_stamp": 0,
            "message": "",
            "pixels_as_float": is_depth,
            "compress": request["compress"],
            "width": rgb.shape[1],
            "height": rgb.shape[0],
            "image_type": request["image_type"],
            **({"annotation_name": ""} if self.flavour == "cosys" else {}),
        }


@dataclass(frozen=True)
class _Turned(Pose):
    """A pose whose turn is a matrix from the camera's body to north, east, down."""

    turn: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))

    @property
    def rotation(self) -> NDArray[np.float64]:
        axes = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
        return np.asarray(axes @ self.turn.T, np.float64)


@contextmanager
def serving(simulator: Simulator) -> Iterator[int]:
    """The simulator on a port of this machine."""

    class Handler(socketserver.BaseRequestHandler):
        """Answers one connection."""

        def handle(self) -> None:
            if simulator.gone:
                return
            unpacker = msgpack.Unpacker(raw=False)
            while data := self.request.recv(1 << 16):
                unpacker.feed(data)
                for _, number, method, arguments in unpacker:
                    try:
                        answer = [1, number, None, simulator.answer(method, arguments)]
                    except ValueError as refusal:
                        answer = [1, number, str(refusal), None]
                    except ConnectionAbortedError:
                        return
                    self.request.sendall(msgpack.packb(answer))

    class Server(socketserver.ThreadingTCPServer):
        """One thread a connection."""

        allow_reuse_address = True
        daemon_threads = True

    with Server(("127.0.0.1", 0), Handler) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield int(server.server_address[1])
        server.shutdown()
        thread.join()
