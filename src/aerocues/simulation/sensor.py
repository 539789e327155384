"""Converts radiance to an 8-bit image: lens, exposure, noise, tone curve."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

_FULL_WELL = 9000.0
"""Electrons of a white pixel, typical of a small sensor: fewer give more photon noise."""

# Electrons of read noise: higher values add noise in shadows.
_READ_NOISE = 4.0
# Signal of a radiance of 1 (white is 1): higher values brighten the image and clip sunlit roofs.
_EXPOSURE = 0.82
# Signal above which highlights are compressed: lower values keep more detail in them, with less
# contrast.
_SHOULDER = 0.72
# Share of the contrast curve in the tone curve: higher values darken shadows and brighten lights.
_CONTRAST = 0.45


@dataclass(frozen=True)
class Sensor:
    """Imperfections of a camera.

    Parameters
    ----------
    noise : float
        Standard deviation of photon and read noise relative to a small sensor at base sensitivity;
        0: none.
    blur : float
        Standard deviation of the point spread of the lens, in pixels.
    motion : float
        Motion along the columns during the exposure, in pixels.
    vignetting : float
        Share of the light lost in the corners.
    exposure_jitter : float
        Standard deviation of the exposure between frames, in stops.
    """

    noise: float = 1.0
    blur: float = 0.55
    motion: float = 0.0
    vignetting: float = 0.22
    exposure_jitter: float = 0.0


def develop(
    radiance: NDArray[np.float32], sensor: Sensor, rng: np.random.Generator
) -> NDArray[np.uint8]:
    """Develop an image from radiance.

    Parameters
    ----------
    radiance : (H, W, 3) float32
        Linear red, green, blue.
    sensor : Sensor
    rng : numpy.random.Generator
        For the noise and the exposure of the frame.

    Returns
    -------
    (H, W, 3) uint8
        Red, green, blue.
    """
    light: Any = _optics(radiance, sensor)
    exposure = _EXPOSURE * 2.0 ** (sensor.exposure_jitter * rng.standard_normal())
    signal = np.minimum(light * exposure, 1.6)
    if sensor.noise > 0:
        deviation = np.sqrt(signal / _FULL_WELL + (_READ_NOISE / _FULL_WELL) ** 2)
        grain = rng.standard_normal(signal.shape, np.float32)
        signal = signal + sensor.noise * deviation * grain
    return tone(np.asarray(signal, np.float32))


def _optics(radiance: NDArray[np.float32], sensor: Sensor) -> Any:
    import cv2

    light: Any = radiance
    if sensor.blur > 0:
        light = cv2.GaussianBlur(light, (0, 0), sensor.blur, borderType=cv2.BORDER_REPLICATE)
    if sensor.motion > 0:
        light = cv2.filter2D(light, -1, _streak(sensor.motion), borderType=cv2.BORDER_REPLICATE)
    height, width = radiance.shape[:2]
    x = (np.arange(width, dtype=np.float32) - (width - 1) / 2) / (width / 2)
    y = (np.arange(height, dtype=np.float32) - (height - 1) / 2) / (width / 2)
    corner = 1 + (height / width) ** 2
    reach = (x[None, :] ** 2 + y[:, None] ** 2) / corner
    return light * (1 - sensor.vignetting * reach)[..., None].astype(np.float32)


def _streak(length: float) -> NDArray[np.float32]:
    """A vertical box filter of a length in pixels, with exact coverage."""
    reach = int(np.ceil((length - 1) / 2)) if length > 1 else 1
    rows = np.arange(-reach, reach + 1)
    cover = np.clip(np.minimum(rows + 0.5, length / 2) - np.maximum(rows - 0.5, -length / 2), 0, 1)
    return np.asarray((cover / cover.sum())[:, None], np.float32)


def tone(signal: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Linear signal (1 is white) to 8 bits: sRGB with compressed highlights."""
    linear = np.maximum(signal, 0.0)
    high = linear > _SHOULDER
    rest = 1 - _SHOULDER
    rolled = np.where(high, _SHOULDER + rest * (1 - np.exp(-(linear - _SHOULDER) / rest)), linear)
    coded = np.where(rolled <= 0.0031308, 12.92 * rolled, 1.055 * rolled ** (1 / 2.4) - 0.055)
    # Cameras increase contrast: a smooth step is mixed in.
    coded = np.clip(coded, 0, 1)
    coded = (1 - _CONTRAST) * coded + _CONTRAST * coded * coded * (3 - 2 * coded)
    return np.asarray(np.rint(coded * 255), np.uint8)
