"""What a drone wrote of the view of a photo."""

from __future__ import annotations

import pytest

from aerocues.datasets.gimbal import GimbalView, gimbal_view

ATTRIBUTES = (
    'drone-dji:RelativeAltitude="+39.80" drone-dji:GimbalRollDegree="+0.00" '
    'drone-dji:GimbalYawDegree="-140.00" drone-dji:GimbalPitchDegree="-89.90"'
)
ELEMENTS = (
    "<drone-dji:RelativeAltitude>39.8</drone-dji:RelativeAltitude>"
    "<drone-dji:GimbalRollDegree>0</drone-dji:GimbalRollDegree>"
    "<drone-dji:GimbalYawDegree>-140</drone-dji:GimbalYawDegree>"
    "<drone-dji:GimbalPitchDegree>-89.9</drone-dji:GimbalPitchDegree>"
)


@pytest.mark.parametrize("packet", [ATTRIBUTES, ELEMENTS])
def test_height_and_angles_are_read(packet: str) -> None:
    assert gimbal_view(packet.encode()) == GimbalView(39.8, -89.9, -140.0, 0.0)


def test_heights_have_more_digits_than_angles() -> None:
    view = gimbal_view(ATTRIBUTES.replace("+39.80", "+1234.50"))
    assert view is not None
    assert view.height == 1234.5


@pytest.mark.parametrize(
    "packet",
    [
        "",
        ATTRIBUTES.replace("GimbalYawDegree", "FlightYawDegree"),
        ATTRIBUTES.replace("+39.80", "-0.40"),
        ATTRIBUTES.replace("+39.80", "high"),
    ],
)
def test_what_lacks_a_value_has_no_view(packet: str) -> None:
    assert gimbal_view(packet) is None
