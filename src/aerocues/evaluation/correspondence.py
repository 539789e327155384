"""Where points of one image truly lie in the other; by a homography where one relates them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pixels
from aerocues.datasets.true_geometry import Points, nearest_pixels


class Correspondence(Protocol):
    """What is known to be true about the points of two images."""

    def errors(self, points_1: Points, points_2: Points) -> NDArray[np.float64]:
        """Distance (N,) in pixels of image 2 between points and where the truth puts them.

        Infinite where the truth puts a point of image 1 nowhere.
        """

    def shared(
        self, points_1: Points, points_2: Points
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The points of each image that the other one shows, both in pixels of image 2.

        Parameters
        ----------
        points_1, points_2 : (N, 2), (M, 2)
            Of image 1 and of image 2; they do not belong together.

        Returns
        -------
        (K, 2), (L, 2) float64
            Points of image 1 where they lie in image 2, and points of image 2 as they are.
        """


@dataclass(frozen=True, eq=False)
class PlaneCorrespondence:
    """Two images that a homography relates.

    Parameters
    ----------
    homography : (3, 3) float64
        From pixels of image 1 to pixels of image 2, pixel centres at integers.
    pixels_1, pixels_2 : Pixels
        Tell which pixels are valid.
    """

    homography: NDArray[np.float64]
    pixels_1: Pixels
    pixels_2: Pixels

    def errors(self, points_1: Points, points_2: Points) -> NDArray[np.float64]:
        distance = np.linalg.norm(transfer(points_1, self.homography) - points_2, axis=1)
        found: NDArray[np.float64] = np.nan_to_num(distance, nan=np.inf)
        return found

    def shared(
        self, points_1: Points, points_2: Points
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        back = np.asarray(np.linalg.inv(self.homography), np.float64)
        first = points_1[covisible(points_1, self.homography, self.pixels_2)]
        second = points_2[covisible(points_2, back, self.pixels_1)]
        return transfer(first, self.homography), second.astype(np.float64)


def transfer(points: Points, homography: NDArray[np.float64]) -> NDArray[np.float64]:
    """Map (N, 2) points; those that pass through infinity become NaN."""
    homogeneous = np.column_stack([points, np.ones(len(points))]).astype(np.float64) @ homography.T
    depth = homogeneous[:, 2:]
    ahead = depth > 1e-12
    moved: NDArray[np.float64] = np.where(
        ahead, homogeneous[:, :2] / np.where(ahead, depth, 1), np.nan
    )
    return moved


def covisible(points: Points, homography: NDArray[np.float64], target: Pixels) -> NDArray[np.bool_]:
    """Which of (N, 2) points fall on valid pixels of the other image."""
    rounded, inside = nearest_pixels(transfer(points, homography), target.bgr.shape[:2])
    if target.valid is not None:
        inside[inside] = target.valid[rounded[inside, 1], rounded[inside, 0]]
    return inside
