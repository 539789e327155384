"""Where keypoints of pyramids lie, as expressions that are valid in Python and in C++.

They say what `aerocues.methods.positions.PYRAMIDS` computes. ``octave`` is the level of a keypoint,
``width`` that of the image, ``extent`` its width or height; ``single`` rounds to a float32,
``nearest`` to a whole number.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from aerocues.methods.parameters import Value

WITHIN = "0.5 * (scale - 1.0)"


@dataclass(frozen=True)
class Level:
    """The expressions of one method; words in braces are its parameters.

    Parameters
    ----------
    scale : str
        What OpenCV multiplies positions by.
    extent : str
        Width or height of the level; may use ``scale``.
    offset : str
        What OpenCV adds, in pixels.
    resized : bool
        Whether sizes of keypoints are wrong, too.
    """

    scale: str
    extent: str
    offset: str = "0.0"
    resized: bool = False

    def filled(self, parameters: Mapping[str, Value]) -> Level:
        """The expressions with the values of parameters in place of their names."""

        def value(found: re.Match[str]) -> str:
            return repr(parameters[found[1]])

        scale, extent = (re.sub(r"\{(\w+)\}", value, text) for text in (self.scale, self.extent))
        return replace(self, scale=scale, extent=extent)


ROUNDED = "nearest(single(extent * single(1.0 / scale)))"
HALVED = "pow(2.0, (octave - octave % 2) / 2)"
TBMR_SCALE = "single(1.0 / single(pow({scale_factor}, octave)))"

LEVELS: Mapping[str, Level] = {
    "ORB": Level("single(pow({scaleFactor}, octave - {firstLevel}))", ROUNDED),
    "AKAZE": Level("pow(2.0, octave)", "floor(extent / scale)", WITHIN),
    "BRISK": Level(
        f"{HALVED} * (1.0 + 0.5 * (octave % 2))",
        f"floor((extent - octave % 2 * (extent - 2.0 * floor(extent / 3.0))) / {HALVED})",
        WITHIN,
    ),
    "HarrisLaplaceFeatureDetector": Level("pow(2.0, octave - 1)", "extent / scale", "0.5 * scale"),
    "MSDDetector": Level(
        "single(pow({m_scale_factor}, octave))", ROUNDED, f"{WITHIN} + 0.5 * (octave == 0)"
    ),
    "TBMR": Level(
        f"nearest(single(width * {TBMR_SCALE})) / width",
        f"nearest(single(extent * {TBMR_SCALE}))",
        resized=True,
    ),
}
"""By the class of OpenCV, as `PYRAMIDS`."""
