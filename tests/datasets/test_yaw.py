"""The yaw that drones write into their images."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image, PngImagePlugin

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.yaw import yaw_of

PACKET = '<rdf:Description drone-dji:FlightYawDegree="+12.50" {}/>'


@pytest.mark.parametrize(
    ("xmp", "yaw"),
    [
        (PACKET.format('drone-dji:GimbalYawDegree="-135.20"'), -135.2),
        (PACKET.format(""), 12.5),
        ("<Camera:Pitch>-1.5</Camera:Pitch><Camera:Yaw> 83.25 </Camera:Yaw>", 83.25),
        (b"\xff<a:GimbalYaw>-7</a:GimbalYaw>", -7.0),
        ('a:YawRate="3" a:Yaw="unknown"', None),
        ('a:Yaw="1000.5"', None),
        (None, None),
    ],
)
def test_the_camera_counts_before_the_drone(xmp: bytes | str | None, yaw: float | None) -> None:
    assert yaw_of(xmp) == yaw


def test_images_of_a_folder_have_the_yaw_of_their_metadata(tmp_path: Path) -> None:
    picture = Image.fromarray(np.zeros((8, 8, 3), np.uint8))
    packet = PACKET.format('drone-dji:GimbalYawDegree="+43.10"')
    picture.save(tmp_path / "1.jpg", xmp=packet.encode())
    text = PngImagePlugin.PngInfo()
    text.add_itxt("XML:com.adobe.xmp", packet)
    picture.save(tmp_path / "2.png", pnginfo=text)
    picture.save(tmp_path / "3.tif", tiffinfo={700: packet.encode()})
    picture.save(tmp_path / "4.jpg")
    assert [image.yaw for image in open_dataset(tmp_path).images] == [43.1, 43.1, 43.1, None]
