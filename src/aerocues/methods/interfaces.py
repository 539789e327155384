"""What a third-party method implements: arrays in, arrays out.

A program adds a method with `aerocues.register`. A package offers one through an entry point in
one of the groups ``aerocues.detectors``, ``aerocues.descriptors``, ``aerocues.extractors``
(detector and descriptor in one), ``aerocues.matchers`` and ``aerocues.pair_matchers``. The entry
point's name, in upper case, is the method's name; its object is called with the method's parameters
(none by default) and returns an object of the kind below.

Any class may state ``upright = True``: it expects images that are not turned against each other;
and ``on_request``, the name of a set of methods that take part only where they are named, or with
``+`` and the name of the set among the patterns. A detector or extractor may state ``limit``, the
name of the parameter by which it chooses its best so many keypoints; any class ``needs_file``, a
file without which it is unavailable (see `aerocues.methods.declarations.why_no_file`).
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import Features, Keypoints, Matches


class Detector(Protocol):
    """Finds keypoints."""

    def detect(self, image: NDArray[np.uint8]) -> Keypoints:
        """Keypoints of `image`, (H, W, 3) uint8 in BGR order."""


class Descriptor(Protocol):
    """Describes keypoints. Its class states ``dtype``: ``"uint8"`` (bits) or ``"float32"``."""

    def describe(self, image: NDArray[np.uint8], keypoints: Keypoints) -> Features:
        """Features of `keypoints`; those that cannot be described are left out."""


class Extractor(Protocol):
    """Detects and describes in one call. Its class states ``dtype``, as a descriptor's does."""

    def extract(self, image: NDArray[np.uint8]) -> Features:
        """Features of `image`, (H, W, 3) uint8 in BGR order."""


class PairMatcher(Protocol):
    """Matches two images as a whole; its name alone is a combination."""

    def match_pair(
        self, image_1: NDArray[np.uint8], image_2: NDArray[np.uint8]
    ) -> tuple[NDArray[np.floating[Any]], ...]:
        """Positions that belong together: two (N, 2) arrays of pixels, and (N,) scores if any.

        The centre of the top-left pixel is (0, 0). The larger a score, the surer the match.
        Positions that are not finite are left out.
        """


class Matcher(Protocol):
    """Matches features one to one.

    Its class states ``dtypes``: for each norm that it knows, the types of descriptors that it
    takes, such as ``{"L2": ("float32",)}``. It may state ``takes_descriptors``, the names of the
    only descriptors that it was made for, such as ``("XFEAT",)``: with others it is incompatible.
    """

    def match(self, features_1: Features, features_2: Features, norm: str) -> Matches:
        """Mutual matches: each feature takes part in one match at most.

        ``image_size`` of both features, width and height in pixels, is always given.
        """
