"""Where keypoints of pyramids really lie.

Detectors look at an image on levels of several sizes. A level has a whole number of pixels, and
its pixel ``x`` lies at ``(x + 0.5) * extent / level_extent - 0.5`` of the image. OpenCV's detectors
forget one or the other, each in its own way, and put keypoints up to some pixels off: all to one
side, so that it does not average out, and to the other side in an image that is turned.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import Int32Array, Keypoints
from aerocues.methods.parameters import Value

Floats = NDArray[np.float64]
Size = tuple[int, int]
"""Width and height of an image in pixels."""
Parameters = Mapping[str, Value]

EXACT_POSITIONS = "exact_positions"
"""Parameter of a detector or descriptor: its positions on levels are corrected."""
GRAY_INPUT = "gray_input"
"""Parameter of a detector: it gets the image in gray."""
OWN_PARAMETERS = (EXACT_POSITIONS, GRAY_INPUT)
"""Parameters that OpenCV does not know."""


@dataclass(frozen=True)
class Pyramid:
    """The levels of a detector, and where OpenCV says that their pixels lie.

    Parameters
    ----------
    level_extent : callable
        From an extent of the image (its width or height), octaves and parameters of the method to
        that of the level.
    scale : callable
        From the size of the image, octaves and parameters to what OpenCV multiplies positions by.
    offset : callable
        From scales and octaves to what it adds then, in pixels.
    inverted : bool
        Whether it divides where it should multiply: sizes of keypoints are then wrong, too.
    """

    level_extent: Callable[[int, Int32Array, Parameters], Floats]
    scale: Callable[[Size, Int32Array, Parameters], Floats]
    offset: Callable[[Floats, Int32Array], Floats] = lambda scale, _: np.zeros_like(scale)
    inverted: bool = False

    def exact(self, found: Keypoints, size: Size, parameters: Parameters) -> Keypoints:
        """Keypoints where they really lie, from those that OpenCV found."""
        scale, offset, ratio = self._level(found.octave, size, parameters)
        xy = ((found.xy - offset) / scale + 0.5) * ratio - 0.5
        diameter = found.size / scale[:, 0] ** 2 if self.inverted else found.size
        return replace(found, xy=xy.astype(np.float32), size=diameter.astype(np.float32))

    def as_found(self, exact: Keypoints, size: Size, parameters: Parameters) -> Keypoints:
        """Keypoints where OpenCV must be told that they are, to look at them where they are."""
        scale, offset, ratio = self._level(exact.octave, size, parameters)
        xy = ((exact.xy + 0.5) / ratio - 0.5) * scale + offset
        return replace(exact, xy=xy.astype(np.float32))

    def _level(
        self, octave: Int32Array, size: Size, parameters: Parameters
    ) -> tuple[Floats, Floats, Floats]:
        """Scale and offset (N, 1), and the pixels of the image in one of the level (N, 2)."""
        scale = self.scale(size, octave, parameters)
        ratio = [extent / self.level_extent(extent, octave, parameters) for extent in size]
        return scale[:, None], self.offset(scale, octave)[:, None], np.column_stack(ratio)


def _single(values: Any) -> Floats:
    """Numbers as OpenCV holds them: near halves, its precision decides how it rounds."""
    return np.asarray(values, np.float32).astype(np.float64)


def _power_of_two(exponent: Int32Array) -> Floats:
    return np.exp2(exponent.astype(np.float64))


def _power(name: str, octave: Int32Array, parameters: Parameters) -> Floats:
    return _single(float(parameters[name]) ** octave.astype(np.float64))


def _rounded(extent: int, scale: Floats) -> Floats:
    return np.rint(_single(extent * _single(1 / scale)))


def _orb_scale(_: Size, octave: Int32Array, parameters: Parameters) -> Floats:
    return _power("scaleFactor", octave - np.int32(parameters["firstLevel"]), parameters)


def _orb_extent(extent: int, octave: Int32Array, parameters: Parameters) -> Floats:
    return _rounded(extent, _orb_scale((0, 0), octave, parameters))


def _msd_extent(extent: int, octave: Int32Array, parameters: Parameters) -> Floats:
    return _rounded(extent, _power("m_scale_factor", octave, parameters))


def _tbmr_extent(extent: int, octave: Int32Array, parameters: Parameters) -> Floats:
    return _rounded(extent, _power("scale_factor", octave, parameters))


def _brisk_scale(_: Size, octave: Int32Array, __: Parameters) -> Floats:
    """Layers are halves of the image and, between them, halves of two thirds of it."""
    return _power_of_two(octave // 2) * np.where(octave % 2, 1.5, 1.0)


def _brisk_extent(extent: int, octave: Int32Array, _: Parameters) -> Floats:
    extents = [extent, 2 * (extent // 3)]
    while len(extents) <= octave.max(initial=0):
        extents.append(extents[-2] // 2)
    return np.array(extents, np.float64)[octave]


def _between_centres(scale: Floats, _: Int32Array) -> Floats:
    """The offset that a level of an exact extent has."""
    return 0.5 * (scale - 1)


PYRAMIDS: Mapping[str, Pyramid] = {
    "ORB": Pyramid(_orb_extent, _orb_scale),
    "AKAZE": Pyramid(
        lambda extent, octave, _: np.floor(extent / _power_of_two(octave)),
        lambda _, octave, __: _power_of_two(octave),
        _between_centres,
    ),
    "BRISK": Pyramid(_brisk_extent, _brisk_scale, _between_centres),
    "HarrisLaplaceFeatureDetector": Pyramid(
        lambda extent, octave, _: extent / _power_of_two(octave - 1),
        lambda _, octave, __: _power_of_two(octave - 1),
        lambda scale, _: 0.5 * scale,
    ),
    "MSDDetector": Pyramid(
        _msd_extent,
        lambda _, octave, parameters: _power("m_scale_factor", octave, parameters),
        lambda scale, octave: np.where(octave, _between_centres(scale, octave), 0.5),
    ),
    "TBMR": Pyramid(
        _tbmr_extent,
        lambda size, octave, parameters: _tbmr_extent(size[0], octave, parameters) / size[0],
        inverted=True,
    ),
}
"""By their class in OpenCV, the methods whose positions are off by what can be corrected."""
