"""Features of one image, and the matches and the geometry of two, in one call."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Geometry
from aerocues.methods.arrays import Features, Float32Array, Matches
from aerocues.methods.combination import Combination
from aerocues.methods.presets import Preset
from aerocues.pipeline.pipeline import ImageLike, Pipeline, decoded

INLIER = (233, 180, 86)
"""Sky blue of Okabe and Ito; blue, green, red."""
FoundGeometry = Literal["fundamental matrix", "homography"]


@dataclass(frozen=True, eq=False)
class MatchedImages:
    """What a combination finds in two images.

    Parameters
    ----------
    combination : Combination
    images : tuple of (H, W, 3) uint8
        Both images, blue, green, red.
    features_1, features_2 : Features
        Their keypoints and descriptors.
    matches : Matches
        M mutual matches: ``indices`` (M, 2) int32 are rows of both features.
    inliers : (M,) bool
        The matches that agree on the geometry; none where there is none.
    geometry : {"fundamental matrix", "homography"} or None
        What `matrix` is; None where no model was found.
    matrix : (3, 3) float64 or None
        Fundamental matrix F with x2^T F x1 = 0, or homography H with x2 ~ H x1; homogeneous
        pixels, the centre of the top-left pixel at (0, 0).
    beats_chance : bool
        Whether there is a model, and it is better than those of shuffled matches, where the preset
        asks that.
    """

    combination: Combination
    images: tuple[NDArray[np.uint8], NDArray[np.uint8]]
    features_1: Features
    features_2: Features
    matches: Matches
    inliers: NDArray[np.bool_]
    geometry: FoundGeometry | None
    matrix: NDArray[np.float64] | None
    beats_chance: bool

    @property
    def points_1(self) -> Float32Array:
        """(M, 2) matched points of the first image, pixels."""
        return self.features_1.keypoints.xy[self.matches.indices[:, 0]]

    @property
    def points_2(self) -> Float32Array:
        """(M, 2) matched points of the second image, pixels."""
        return self.features_2.keypoints.xy[self.matches.indices[:, 1]]

    def __repr__(self) -> str:
        found = f"of a {self.geometry}" if self.geometry else "as no model was found"
        chance = "" if self.beats_chance or self.geometry is None else ", no better than chance"
        return (
            f"MatchedImages {self.combination}: {len(self.features_1):,} and "
            f"{len(self.features_2):,} keypoints, {len(self.matches):,} matches, "
            f"{int(self.inliers.sum()):,} inliers {found}{chance}"
        )

    def picture(self, width: int = 1200, lines: int = 100) -> NDArray[np.uint8]:
        """Both images side by side: a dot at each inlier, and lines between some of them.

        Parameters
        ----------
        width : int
            Pixels.
        lines : int
            How many to draw at most, a seeded sample.

        Returns
        -------
        (H, `width`, 3) uint8
            Blue, green, red.
        """
        first, second = self.images
        height, offset = max(first.shape[0], second.shape[0]), first.shape[1]
        canvas = np.full((height, offset + second.shape[1], 3), 255, np.uint8)
        canvas[: first.shape[0], :offset] = first
        canvas[: second.shape[0], offset:] = second
        factor = width / canvas.shape[1]
        size = (width, max(1, round(height * factor)))
        shown = cv2.resize(canvas, size, interpolation=cv2.INTER_AREA)
        moved = self.points_2 + np.array([offset, 0], np.float32)
        matched = np.stack([self.points_1, moved], axis=1)[self.inliers]
        ends = np.round((matched + 0.5) * factor * 16 - 8).astype(np.int32)
        for start, end in np.random.default_rng(0).permutation(ends)[:lines].tolist():
            cv2.line(shown, start, end, INLIER, 1, cv2.LINE_AA, shift=4)
        for place in ends.reshape(-1, 2).tolist():
            cv2.circle(shown, place, 24, INLIER, -1, cv2.LINE_AA, shift=4)
        return np.asarray(shown, np.uint8)

    def _repr_jpeg_(self) -> bytes:
        _, content = cv2.imencode(".jpg", self.picture(), [cv2.IMWRITE_JPEG_QUALITY, 80])
        return bytes(content)


def features(
    image: ImageLike,
    combination: str | Combination,
    preset: str | Preset = "default",
    *,
    max_keypoints: int = 0,
    seed: int = 0,
) -> Features:
    """Detect and describe the keypoints of an image.

    Parameters
    ----------
    image : path, (H, W, 3) or (H, W) uint8 array, or Image
        An image file; blue, green, red, or gray; or an image of a dataset.
    combination : str or Combination
        Such as ``"ORB-BEBLID-HAM-BF"``, in any case.
    preset : str or Preset
        Parameters of the methods.
    max_keypoints : int
        The strongest keypoints that are kept; 0 keeps all.
    seed : int
        Set before every call of OpenCV.

    Returns
    -------
    Features
        N keypoints that could be described, and their (N, D) uint8 or float32 descriptors.

    Raises
    ------
    AerocuesError
        If there is no such combination or image, an argument makes no sense, or a method fails.
    """
    return Pipeline(combination, preset, max_keypoints=max_keypoints, seed=seed).features(image)


def match(
    image_1: ImageLike,
    image_2: ImageLike,
    combination: str | Combination,
    preset: str | Preset = "default",
    *,
    max_keypoints: int = 0,
    seed: int = 0,
    geometry: Geometry = "epipolar",
) -> MatchedImages:
    """Match two images and verify their geometry, as `run` measures it.

    Parameters
    ----------
    image_1, image_2 : path, (H, W, 3) or (H, W) uint8 array, or Image
        Image files; blue, green, red, or gray; or images of a dataset.
    combination : str or Combination
        Such as ``"ORB-BEBLID-HAM-BF"``, in any case.
    preset : str or Preset
        Parameters of the methods, inlier thresholds, and whether a model must beat chance.
    max_keypoints : int
        The strongest keypoints that are kept in an image; 0 keeps all.
    seed : int
        Set before every call of OpenCV.
    geometry : {"epipolar", "homography"}
        ``homography`` where the images show a plane or are taken from one place: where no
        fundamental matrix beats chance, a homography is tried, too.

    Returns
    -------
    MatchedImages
        Keypoints, matches, the mask of inliers and the geometry.

    Raises
    ------
    AerocuesError
        If there is no such combination or image, an argument makes no sense, or a method fails.
    """
    pipeline = Pipeline(
        combination, preset, max_keypoints=max_keypoints, seed=seed, geometry=geometry
    )
    images = decoded(image_1, image_2)
    first, second, matches = pipeline.match_images(*images)
    verdict = pipeline.verify(first, second, matches)
    found: FoundGeometry = (
        "homography" if verdict.sampling == "homography" else "fundamental matrix"
    )
    return MatchedImages(
        combination=pipeline.combination,
        images=(images[0].read().bgr, images[1].read().bgr),
        features_1=first,
        features_2=second,
        matches=matches,
        inliers=verdict.model.inliers,
        geometry=None if verdict.model.matrix is None else found,
        matrix=verdict.model.matrix,
        beats_chance=verdict.passed,
    )
