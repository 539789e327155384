"""Metadata as drones write it: EXIF with GPS, and DJI's XMP with gimbal angles."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import GpsPosition, PinholeCamera
from aerocues.simulation.camera import Pose

_MAKE, _MODEL, _SOFTWARE, _EXIF, _GPS = 271, 272, 305, 34665, 34853
_FOCAL_LENGTH, _PLANE_X, _PLANE_Y, _PLANE_UNIT, _FOCAL_35 = 37386, 41486, 41487, 41488, 41989
_WIDTH, _HEIGHT = 40962, 40963
_CENTIMETRE = 3
_REQUIRED = {282: 72.0, 283: 72.0, 296: 2, 531: 1}
"""Tags that EXIF requires of every image: pixels per inch, position of the chroma samples."""

_REQUIRED_OF_CAMERA = {36864: b"0232", 37121: b"\x01\x02\x03\x00", 40960: b"0100", 40961: 1}
"""Tags that EXIF requires of cameras: versions of EXIF and FlashPix, components, colour space."""

_SENSOR_WIDTH = 36.0
"""Millimetres, so that the focal length equals the one on 35 mm film."""

# JPEG quality: higher has fewer artefacts and larger files.
_QUALITY = 95
_XMP = """<?xpacket begin="\ufeff" id="W5M0MpCehiHzreSzNTczkc9d"?>
<x:xmpmeta xmlns:x="adobe:ns:meta/">
 <rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">
  <rdf:Description rdf:about="" xmlns:drone-dji="http://www.dji.com/drone-dji/1.0/"
   {fields}/>
 </rdf:RDF>
</x:xmpmeta>
<?xpacket end="w"?>"""


def gimbal_angles(pose: Pose) -> tuple[float, float, float]:
    """Pitch, yaw and roll in degrees in the convention of gimbals: pitch from -90 to 90.

    Beyond the nadir the camera is upside down and faces the opposite direction: pitch -120 and yaw
    y are pitch -60, yaw y + 180, roll 180.
    """
    pitch, yaw, roll = pose.pitch, pose.yaw, pose.roll
    if pitch < -90.0:
        pitch, yaw, roll = -180.0 - pitch, yaw + 180.0, roll + 180.0
    return pitch, _half_turn(yaw), _half_turn(roll)


def _half_turn(angle: float) -> float:
    """The same direction in (-180, 180]."""
    return 180.0 - (180.0 - angle) % 360.0


def write_image(
    path: Path,
    rgb: NDArray[np.uint8],
    camera: PinholeCamera,
    pose: Pose,
    gps: GpsPosition,
) -> None:
    """Write a PNG or JPEG file, depending on the suffix, with its metadata.

    It is written to a temporary file and renamed, so that there is never a partial image.
    """
    from PIL import Image, PngImagePlugin

    picture = Image.fromarray(rgb)
    exif = _exif(camera, gps).tobytes()
    packet = _xmp(pose, gps)
    part = path.with_name(f".{path.name}.part")
    if path.suffix == ".png":
        text = PngImagePlugin.PngInfo()
        text.add_itxt("XML:com.adobe.xmp", packet)
        picture.save(part, format="PNG", exif=exif, pnginfo=text, compress_level=4)
    else:
        picture.save(
            part, format="JPEG", exif=exif, xmp=packet.encode(), quality=_QUALITY, subsampling=0
        )
    part.replace(path)


def _exif(camera: PinholeCamera, gps: GpsPosition) -> Any:
    from PIL import Image
    from PIL.TiffImagePlugin import IFDRational

    exif = Image.Exif()
    exif[_MAKE], exif[_MODEL], exif[_SOFTWARE] = "aerocues", "simulated", "aerocues"
    exif.update(_REQUIRED)
    millimetres = camera.focal_x * _SENSOR_WIDTH / camera.width
    density = camera.width / _SENSOR_WIDTH * 10
    exif[_EXIF] = {
        _FOCAL_LENGTH: IFDRational(round(millimetres * 1e6), 10**6),
        _PLANE_X: IFDRational(round(density * 1e6), 10**6),
        _PLANE_Y: IFDRational(round(density * 1e6), 10**6),
        _PLANE_UNIT: _CENTIMETRE,
        _FOCAL_35: round(millimetres),
        _WIDTH: camera.width,
        _HEIGHT: camera.height,
        **_REQUIRED_OF_CAMERA,
    }
    altitude = gps.altitude or 0.0
    exif[_GPS] = {
        0: b"\x02\x03\x00\x00",
        1: "N" if gps.latitude >= 0 else "S",
        2: _sexagesimal(abs(gps.latitude)),
        3: "E" if gps.longitude >= 0 else "W",
        4: _sexagesimal(abs(gps.longitude)),
        5: b"\x00" if altitude >= 0 else b"\x01",
        6: IFDRational(round(abs(altitude) * 1000), 1000),
    }
    return exif


def _sexagesimal(degrees: float) -> tuple[Any, Any, Any]:
    """Degrees, minutes and seconds; seconds in millionths, 0.03 mm on the ground."""
    from PIL.TiffImagePlugin import IFDRational

    micro = round(degrees * 3600 * 10**6)
    minutes, seconds = divmod(micro, 60 * 10**6)
    return (
        IFDRational(minutes // 60, 1),
        IFDRational(minutes % 60, 1),
        IFDRational(seconds, 10**6),
    )


def _xmp(pose: Pose, gps: GpsPosition) -> str:
    pitch, yaw, roll = gimbal_angles(pose)
    values = {
        "AbsoluteAltitude": f"{gps.altitude or 0.0:+.3f}",
        "RelativeAltitude": f"{-pose.down:+.3f}",
        "GpsLatitude": f"{gps.latitude:.10f}",
        "GpsLongitude": f"{gps.longitude:.10f}",
        "GimbalPitchDegree": f"{pitch:+.2f}",
        "GimbalYawDegree": f"{yaw:+.2f}",
        "GimbalRollDegree": f"{roll:+.2f}",
    }
    return _XMP.format(
        fields="\n   ".join(f'drone-dji:{name}="{value}"' for name, value in values.items())
    )
