"""The matcher GMS: a match is right where enough matches around it move alike."""

from __future__ import annotations

import numpy as np

from aerocues.methods.arrays import Features, Matches
from aerocues.methods.parameters import why_missing


def why_not_gms() -> str | None:
    """Why GMS cannot be used here, or None: it is one of OpenCV's contributed modules."""
    import cv2

    if hasattr(getattr(cv2, "xfeatures2d", None), "matchGMS"):
        return None
    return why_missing("matchGMS")


class GmsMatcher:
    """Cross-checked brute force, filtered by ``cv2.xfeatures2d.matchGMS``.

    Parameters
    ----------
    with_rotation, with_scale : bool
        Whether images may be turned, or of another scale.
    threshold_factor : float
        The larger, the more matches around must move alike.
    """

    def __init__(self, with_rotation: bool, with_scale: bool, threshold_factor: float) -> None:
        self._settings = {
            "withRotation": with_rotation,
            "withScale": with_scale,
            "thresholdFactor": threshold_factor,
        }

    def match(self, features_1: Features, features_2: Features, norm: str) -> Matches:
        """The matches of BF that are kept."""
        import cv2

        kind = cv2.NORM_L2 if norm == "L2" else cv2.NORM_HAMMING
        both = (features_1, features_2)
        native = cv2.BFMatcher(kind, crossCheck=True).match(
            *(features.descriptors for features in both)
        )
        if not native:
            return Matches()
        sizes = [features.image_size for features in both]
        keypoints = [features.keypoints.to_opencv() for features in both]
        kept = cv2.xfeatures2d.matchGMS(*sizes, *keypoints, native, **self._settings)
        rows = [(match.queryIdx, match.trainIdx) for match in kept]
        distance = np.array([match.distance for match in kept], np.float32)
        return Matches(np.array(rows, np.int32).reshape(-1, 2), distance)
