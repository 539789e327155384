"""Features that may be needed again, as long as they fit into memory."""

from __future__ import annotations

from collections import OrderedDict

from aerocues.pipeline.features import Failure, ImageFeatures

CACHE_BYTES = 256 * 2**20
Key = tuple[str, str]
"""Detector and image."""


class FeatureCache:
    """The features of the images that were used last.

    Parameters
    ----------
    most : int
        Bytes that are kept beyond what is in use.
    """

    def __init__(self, most: int = CACHE_BYTES) -> None:
        self._most = most
        self._kept: OrderedDict[Key, ImageFeatures | Failure] = OrderedDict()

    def get(self, key: Key) -> ImageFeatures | Failure | None:
        """What is kept of an image under a detector; it counts as used last."""
        found = self._kept.get(key)
        if found is not None:
            self._kept.move_to_end(key)
        return found

    def put(self, key: Key, features: ImageFeatures | Failure) -> None:
        self._kept[key] = features

    def trim(self, needed: frozenset[Key]) -> None:
        """Drop what was used longest ago until the rest fits; what is needed stays.

        A failure is not kept: lack of memory may be over.
        """
        sizes = {key: _bytes(features) for key, features in self._kept.items()}
        total = sum(sizes.values())
        for key in [key for key in self._kept if key not in needed]:
            if total > self._most or isinstance(self._kept[key], Failure):
                del self._kept[key]
                total -= sizes[key]


def _bytes(features: ImageFeatures | Failure) -> int:
    if isinstance(features, Failure):
        return 0
    described = [each for each in features.described.values() if not isinstance(each, Failure)]
    # What OpenCV makes of keypoints is about as large as they are; 200 bytes each.
    return (
        features.pixels.bgr.nbytes
        + 200 * len(features.keypoints) * (1 + len(features.prepared) + len(described))
        + sum(each.features.descriptors.nbytes for each in described)
    )
