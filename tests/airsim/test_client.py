"""The server of these tests, driven by the client that users of AirSim have."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from aerocues.simulation.camera import Pose
from tests.airsim.server import Simulator, plain, serving

cosysairsim: Any = pytest.importorskip("cosysairsim", reason="cosysairsim is not installed")


@pytest.fixture
def simulator() -> Simulator:
    return Simulator("cosys")


@pytest.fixture
def client(simulator: Simulator) -> Iterator[Any]:
    with serving(simulator) as port:
        client = cosysairsim.VehicleClient(port=port, timeout_value=10)
        yield client
        client.client.close()


def test_the_maintained_client_understands_the_server(client: Any, simulator: Simulator) -> None:
    client.confirmConnection()
    client.simSetCameraFov("0", 90)
    turn = cosysairsim.euler_to_quaternion(0, np.radians(-60), np.radians(30))
    place = cosysairsim.Pose(cosysairsim.Vector3r(5, -7, -40), turn)
    client.simSetVehiclePose(place, True)
    requests = [
        cosysairsim.ImageRequest("0", cosysairsim.ImageType.Scene, False, True),
        cosysairsim.ImageRequest("0", cosysairsim.ImageType.DepthPlanar, True, False),
    ]
    colour, depth = client.simGetImages(requests)
    assert colour.camera_position.z_val == -40
    got = np.array(depth.image_data_float, np.float32).reshape(depth.height, depth.width)
    # Its angles and ours are the same.
    _, expected = plain(Pose(5, -7, -40, -60, 30), simulator.width, simulator.height, 90.0)
    np.testing.assert_allclose(got, expected, rtol=1e-5)
    assert client.simGetCameraInfo("0").fov == 90
