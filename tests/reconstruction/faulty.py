"""Third-party methods that go wrong while a scene is reconstructed."""

from __future__ import annotations

import os
import signal
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import Features, Keypoints

Image = NDArray[np.uint8]


class NanDescriptor:
    """Returns keypoints whose positions are no numbers."""

    dtype = "uint8"

    def describe(self, image: Image, keypoints: Keypoints) -> Features:
        found: Any = cv2.ORB_create()
        native, descriptors = found.compute(image, keypoints.to_opencv())
        described = Keypoints.from_opencv(native)
        xy = np.full_like(described.xy, np.nan)
        return Features(replace(described, xy=xy), descriptors)


class DyingDescriptor:
    """Ends its process."""

    dtype = "uint8"

    def describe(self, image: Image, keypoints: Keypoints) -> Features:
        os.kill(os.getpid(), signal.SIGSEGV)
        raise AssertionError


class GreedyDescriptor:
    """Asks for more memory than there is."""

    dtype = "uint8"

    def describe(self, image: Image, keypoints: Keypoints) -> Features:
        return Features(keypoints, np.ones((200_000, 1_000_000), np.uint8))
