"""A pair matcher of a user: corners that are followed from one image into the other and back."""

from __future__ import annotations

from typing import Any, ClassVar

import cv2
import numpy as np
from numpy.typing import NDArray


class Follow:
    """As the guide shows it."""

    reference = "Lucas and Kanade, An iterative image registration technique, IJCAI 1981"
    parameters: ClassVar = {"corners": 2000}
    upright = True

    def __init__(self, corners: int) -> None:
        self.corners = corners

    def match_pair(self, image_1: NDArray[np.uint8], image_2: NDArray[np.uint8]) -> Any:
        first, second = (cv2.cvtColor(each, cv2.COLOR_BGR2GRAY) for each in (image_1, image_2))
        shift, _ = cv2.phaseCorrelate(np.float32(first), np.float32(second))
        start = cv2.goodFeaturesToTrack(first, self.corners, 0.01, 5)
        there, _, _ = cv2.calcOpticalFlowPyrLK(
            first, second, start, start + np.float32(shift), flags=cv2.OPTFLOW_USE_INITIAL_FLOW
        )
        back, _, _ = cv2.calcOpticalFlowPyrLK(
            second, first, there, start.copy(), flags=cv2.OPTFLOW_USE_INITIAL_FLOW
        )
        error = np.linalg.norm(back - start, axis=2)[:, 0]
        kept = error < 0.5
        return start[kept, 0], there[kept, 0], -error[kept]
