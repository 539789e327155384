"""True matches without ground truth: a reference that is made of the two images alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from aerocues.datasets.dataset import Pixels
from aerocues.datasets.fitting import resize, scale_matrix
from aerocues.errors import MethodUnavailableError
from aerocues.methods.arrays import Features
from aerocues.pipeline.reference_flow import (
    Flow,
    FlowCorrespondence,
    Matrix,
    between_sizes,
    find_flow,
    why_missing_interpolator,
)
from aerocues.pipeline.reference_seeds import NoReferenceError, SeedMethods

# Raised whenever the same images would give another reference.
REFERENCE_VERSION = 2
FLOW = "flow"
"""The verdict where there is a reference."""

# Larger images are halved until they are no larger: the flow of 12 megapixels takes minutes.
LARGEST = 2000
AGREEING, TRUSTED = 3.0, 0.5


@dataclass(frozen=True, eq=False)
class Reference:
    """What the matches of two images are compared with.

    Parameters
    ----------
    verdict : str
        `FLOW`, or the reason why there is no reference.
    agreement : float or None
        Share of the seeds within `AGREEING` pixels of the flow; None where there is no flow.
    flow : Flow or None
        None where it is not trusted.
    """

    verdict: str
    agreement: float | None = None
    flow: Flow | None = None

    @property
    def turn(self) -> float | None:
        """By how many degrees, 0 to 180, image 2 is turned against image 1 at its centre."""
        if self.flow is None:
            return None
        matrix = self.flow.after
        height, width = self.flow.steps.shape[:2]
        x, y, z = matrix @ ((width - 1) / 2, (height - 1) / 2, 1.0)
        # The derivative of (x / z, y / z) times z; of it the nearest rotation.
        slope = matrix[:2, :2] - np.outer((x / z, y / z), matrix[2, :2])
        (a, b), (c, d) = (slope * np.sign(z)).tolist()
        return abs(math.degrees(math.atan2(c - b, a + d)))

    def correspondence(self, pixels_1: Pixels, pixels_2: Pixels) -> FlowCorrespondence | None:
        """What tells right matches from wrong ones; None where there is no reference."""
        return FlowCorrespondence(self.flow, pixels_1, pixels_2) if self.flow else None


@dataclass(frozen=True, eq=False)
class PreparedImage:
    """What a reference is built of.

    Parameters
    ----------
    pixels : Pixels
        Not larger than `LARGEST`.
    shrink : (3, 3) float64
        To those pixels from those of the image.
    features : tuple of Features
        One for each method that seeds are found with.
    """

    pixels: Pixels
    shrink: Matrix
    features: tuple[Features, ...]


class ReferenceBuilder:
    """Builds references: seeds, a homography, a dense flow, and whether the seeds agree with it.

    1. Seeds: mutual matches of SIFT, AKAZE and GFTT-DAISY, of which those count that lie within 1.5
       pixels of the lines of one fundamental matrix (MAGSAC++), if they are half as many again as
       shuffled matches give.
    2. A homography of the seeds takes the large motion out: image 2 is warped onto image 1.
    3. The seeds' motion is spread along the edges of the picture, and refined by inverse search
       (Kroeger et al., Fast optical flow using dense inverse search, ECCV 2016).
    4. It is trusted where at least half of the seeds lie within 3 pixels of it.

    The same images and version of OpenCV give the same reference, bit for bit.

    Raises
    ------
    MethodUnavailableError
        If this build of OpenCV lacks what it takes.
    """

    def __init__(self) -> None:
        missing = why_missing_interpolator()
        if missing:
            raise MethodUnavailableError(f"there is no reference: {missing}")
        self._methods = SeedMethods()

    def prepare(self, pixels: Pixels) -> PreparedImage:
        """What is needed of an image, whatever it is paired with.

        Parameters
        ----------
        pixels : Pixels
            As methods get them; nothing is looked for on what is not valid.

        Raises
        ------
        cv2.error
            If OpenCV refuses the image.
        """
        height, width = pixels.bgr.shape[:2]
        halvings = max(math.ceil(math.log2(max(height, width) / LARGEST)), 0)
        size = max(width >> halvings, 1), max(height >> halvings, 1)
        small = resize(pixels, size) if halvings else pixels
        shrink = scale_matrix((width, height), size)
        return PreparedImage(small, shrink, self._methods.features(small))

    def build(self, first: PreparedImage, second: PreparedImage) -> Reference:
        """The reference of two images.

        Raises
        ------
        cv2.error
            If OpenCV lacks memory.
        """
        try:
            seeds = self._methods.seeds(first.features, second.features)
            flow = find_flow(first.pixels, second.pixels, seeds)
        except NoReferenceError as reason:
            return Reference(str(reason))
        found = FlowCorrespondence(flow, first.pixels, second.pixels)
        agreement = float((found.errors(seeds.points_1, seeds.points_2) <= AGREEING).mean())
        if agreement < TRUSTED:
            share = f"{agreement:.0%}"
            return Reference(f"only {share} of the matches of the images fit one flow", agreement)
        return Reference(FLOW, agreement, between_sizes(flow, first.shrink, second.shrink))
