"""LIGHTERGLUE and LIGHTGLUE: matchers that see all keypoints of both images at once."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from aerocues import Features, Matches
from aerocues_learned.images import Float32Array
from aerocues_learned.sessions import CPU, Network
from aerocues_learned.weights import FOLDER, NEEDED, lightglue_weights


class LightGlueMatcher:
    """What both matchers share.

    Parameters
    ----------
    graph : Path
    threshold : float
        The confidence that a match must exceed, 0 to 1.
    provider : str
        ONNX Runtime's name of what computes.
    """

    dtypes: ClassVar[dict[str, tuple[str, ...]]] = {"L2": ("float32",)}
    # The positions of keypoints count, as seen in upright images.
    upright = True
    name: ClassVar[str]

    def __init__(self, graph: Path, threshold: float, provider: str) -> None:
        self._threshold = threshold
        self._network = Network(graph, provider)

    def match(self, features_1: Features, features_2: Features, norm: str) -> Matches:
        """Mutual matches; their distance is 1 less the confidence.

        Raises
        ------
        ValueError
            If features do not tell the size of their image.
        """
        best_1, best_2, confidence = self._network(
            keypoints_1=self._normalised(features_1),
            descriptors_1=features_1.descriptors[None],
            keypoints_2=self._normalised(features_2),
            descriptors_2=features_2.descriptors[None],
        )
        rows = np.arange(len(best_1))
        kept = (best_2[best_1] == rows) & (confidence > self._threshold)
        indices = np.stack([rows[kept], best_1[kept]], axis=1).astype(np.int32)
        return Matches(indices, np.asarray(1 - confidence[kept], np.float32))

    def _normalised(self, features: Features) -> Float32Array:
        """Positions with the centre of the image at (0, 0) and its longest side from -1 to 1."""
        if features.image_size is None:
            raise ValueError(
                f"{self.name} needs the size of the images; give Features their image_size"
            )
        size = np.array(features.image_size, np.float32)
        return np.asarray((features.keypoints.xy - size / 2) / (size.max() / 2), np.float32)[None]


class LighterGlue(LightGlueMatcher):
    """LIGHTERGLUE: the small one, for XFEAT."""

    name = "LIGHTERGLUE"
    title = "LightGlue in six layers, for XFEAT"
    reference = "Potje et al., XFeat (CVPR 2024), after Lindenberger et al., LightGlue, ICCV 2023"
    takes_descriptors = ("XFEAT",)
    on_request = "learned"
    parameters: ClassVar[dict[str, Any]] = {"threshold": 0.1, "provider": CPU}

    def __init__(self, threshold: float, provider: str) -> None:
        super().__init__(FOLDER / "lighterglue-xfeat.onnx", threshold, provider)


class LightGlue(LightGlueMatcher):
    """LIGHTGLUE: the large one, for ALIKED_N16ROT; its weights are a file of their own."""

    name = "LIGHTGLUE"
    title = "LightGlue in nine layers, for ALIKED"
    reference = "Lindenberger et al., LightGlue: local feature matching at light speed, ICCV 2023"
    # ALIKED_T16 has descriptors of another length.
    takes_descriptors = ("ALIKED_N16ROT",)
    # A set of its own: whoever asks for all learned methods may not have its weights.
    on_request = "lightglue"
    parameters: ClassVar[dict[str, Any]] = {"threshold": 0.1, "provider": CPU}
    needs_file = NEEDED

    def __init__(self, threshold: float, provider: str) -> None:
        super().__init__(lightglue_weights(), threshold, provider)
