"""True positions of points of one image in the other image, from a homography."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pixels
from aerocues.datasets.true_geometry import Points, nearest_pixels


class Correspondence(Protocol):
    """True correspondence between the points of two images."""

    def errors(self, points_1: Points, points_2: Points) -> NDArray[np.float64]:
        """Distance (N,) in pixels of image 2 between points and their true positions.

        Infinite if a point of image 1 has no true position in image 2.
        """

    def shared(
        self, points_1: Points, points_2: Points
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The points of each image that are visible in the other, both in pixels of image 2.

        Parameters
        ----------
        points_1, points_2 : (N, 2), (M, 2)
            Points of image 1 and points of image 2, which are not matched.

        Returns
        -------
        (K, 2), (L, 2) float64
            Points of image 1 mapped to image 2, and points of image 2 unchanged.
        """


@dataclass(frozen=True, eq=False)
class PlaneCorrespondence:
    """Two images that are related by a homography.

    Parameters
    ----------
    homography : (3, 3) float64
        From pixels of image 1 to pixels of image 2, pixel centres at integers.
    pixels_1, pixels_2 : Pixels
        Masks of valid pixels.
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
    """Map (N, 2) points; points that are mapped to infinity become NaN."""
    homogeneous = np.column_stack([points, np.ones(len(points))]).astype(np.float64) @ homography.T
    depth = homogeneous[:, 2:]
    ahead = depth > 1e-12
    moved: NDArray[np.float64] = np.where(
        ahead, homogeneous[:, :2] / np.where(ahead, depth, 1), np.nan
    )
    return moved


def covisible(points: Points, homography: NDArray[np.float64], target: Pixels) -> NDArray[np.bool_]:
    """Mask (N,) of the points that fall on valid pixels of the other image."""
    return shown(transfer(points, homography), target)


def shown(points: NDArray[np.float64], pixels: Pixels) -> NDArray[np.bool_]:
    """Mask (N,) of the points that lie on valid pixels of an image; NaN lies on none."""
    rounded, inside = nearest_pixels(points, pixels.bgr.shape[:2])
    if pixels.valid is not None:
        inside[inside] = pixels.valid[rounded[inside, 1], rounded[inside, 0]]
    return inside
