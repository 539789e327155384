"""Where every point of one image lies in another: a homography, and a dense flow beyond it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pixels
from aerocues.datasets.true_geometry import Points, nearest_pixels
from aerocues.methods.parameters import NEXT_STEP
from aerocues.pipeline.correspondence import covisible, shown, transfer
from aerocues.pipeline.protocol import Verification
from aerocues.pipeline.reference_seeds import CONFIDENCE, ITERATIONS, SEED, NoReferenceError, Seeds
from aerocues.pipeline.verification import estimate_homography, magsac_parameters

Matrix = NDArray[np.float64]

# Takes out the large motion: relief may lie this many pixels off the plane.
PLANE = Verification(10.0, CONFIDENCE, ITERATIONS)
# A seed starts the flow where so many of its neighbours move as it does, within so many pixels.
NEIGHBOURS, ALIKE, SAME_MOTION = 5, 2, 4.0
FEWEST_STARTS, NEAREST_STARTS = 16, 32
STEPS_PER_PIXEL = 32
MOST_STEPS = 32767


@dataclass(frozen=True, eq=False)
class Flow:
    """Puts each point of image 1 into image 2.

    Parameters
    ----------
    before : (3, 3) float64
        From pixels of image 1 to those of the flow.
    steps : (H, W, 2) int16
        How far the point of each pixel moves, right and down, in parts of a pixel of the flow:
        `STEPS_PER_PIXEL` of them are one.
    after : (3, 3) float64
        A homography from where the points have moved to pixels of image 2.
    """

    before: Matrix
    steps: NDArray[np.int16]
    after: Matrix

    @property
    def homography(self) -> Matrix:
        """The flow without its steps, from pixels of image 1 to pixels of image 2."""
        return np.asarray(self.after @ self.before, np.float64)

    def moved(self, points: Points) -> NDArray[np.float64]:
        """Where points (N, 2) of image 1 lie in image 2; NaN where they are in neither."""
        at = transfer(points, self.before)
        return transfer(at + self._step(at), self.after)

    def _step(self, at: NDArray[np.float64]) -> NDArray[np.float64]:
        """The move of points (N, 2), in pixels of the flow, between its pixels; NaN outside."""
        height, width = self.steps.shape[:2]
        inside = nearest_pixels(at, (height, width))[1]
        x, y = np.clip(np.nan_to_num(at), 0, (width - 1, height - 1)).T
        left = np.minimum(x.astype(np.intp), max(width - 2, 0))
        top = np.minimum(y.astype(np.intp), max(height - 2, 0))
        u, v = x - left, y - top
        first = top * width + left
        corners = self.steps.reshape(-1, 2)[[first, first + 1, first + width, first + width + 1]]
        shares = np.array([(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v]) / STEPS_PER_PIXEL
        step: NDArray[np.float64] = np.einsum("cn,cnk->nk", shares, corners)
        step[~inside] = np.nan
        return step


@dataclass(frozen=True, eq=False)
class FlowCorrespondence:
    """Two images that a flow relates; a `Correspondence`.

    Whether image 1 shows a point of image 2 is told by the homography alone.
    """

    flow: Flow
    pixels_1: Pixels
    pixels_2: Pixels

    def errors(self, points_1: Points, points_2: Points) -> NDArray[np.float64]:
        distance = np.linalg.norm(self.flow.moved(points_1) - points_2, axis=1)
        return np.asarray(np.nan_to_num(distance, nan=np.inf), np.float64)

    def shared(
        self, points_1: Points, points_2: Points
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        moved = self.flow.moved(points_1)
        back = np.asarray(np.linalg.inv(self.flow.homography), np.float64)
        seen = points_2[covisible(points_2, back, self.pixels_1)]
        return moved[shown(moved, self.pixels_2)], seen.astype(np.float64)


def find_flow(first: Pixels, second: Pixels, seeds: Seeds) -> Flow:
    """The flow from one image to another.

    Parameters
    ----------
    first, second : Pixels
    seeds : Seeds
        Right matches, nearly all of them.

    Raises
    ------
    NoReferenceError
        If no homography comes near the seeds.
    cv2.error
        If OpenCV refuses the images.
    """
    model = estimate_homography(seeds.points_1, seeds.points_2, magsac_parameters(PLANE, seed=SEED))
    if model.matrix is None:
        raise NoReferenceError("no homography takes the matches of the two images near each other")
    height, width = first.bgr.shape[:2]
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    warped: Any = cv2.warpPerspective(second.bgr, model.matrix, (width, height), flags=flags)
    start = _start(first.bgr, warped, _steady(_warped_back(seeds, model.matrix)))
    gray_1, gray_2 = (cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) for image in (first.bgr, warped))
    search = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
    search.setFinestScale(0)
    moves = search.calc(gray_1, gray_2, start)
    steps = np.clip(np.rint(moves * STEPS_PER_PIXEL), -MOST_STEPS, MOST_STEPS).astype(np.int16)
    return Flow(np.eye(3), steps, model.matrix)


def between_sizes(flow: Flow, from_1: Matrix, from_2: Matrix) -> Flow:
    """A flow between other sizes of the same images, by the (3, 3) matrices that shrink those."""
    after = np.asarray(np.linalg.inv(from_2) @ flow.after, np.float64)
    return replace(flow, before=flow.before @ from_1, after=after)


def _warped_back(seeds: Seeds, homography: Matrix) -> Seeds:
    back = transfer(seeds.points_2, np.asarray(np.linalg.inv(homography), np.float64))
    ahead = np.isfinite(back).all(axis=1)
    return Seeds(seeds.points_1[ahead], back[ahead].astype(np.float32))


def _steady(seeds: Seeds) -> Seeds:
    """Seeds that move as some of their neighbours do."""
    from scipy.spatial import cKDTree

    if len(seeds) <= NEIGHBOURS:
        return seeds
    move = seeds.points_2 - seeds.points_1
    near = np.asarray(cKDTree(seeds.points_1).query(seeds.points_1, NEIGHBOURS + 1)[1])
    difference = np.linalg.norm(move[near[:, 1:]] - move[:, None], axis=2)
    return seeds.take((difference < SAME_MOTION).sum(axis=1) >= ALIKE)


def why_missing_interpolator() -> str | None:
    """Why this build of OpenCV cannot spread the motion of seeds, or None where it can."""
    if hasattr(cv2, "ximgproc"):
        return None
    return f"this OpenCV ({cv2.__version__}) has no ximgproc; {NEXT_STEP}"


def _start(
    first: NDArray[np.uint8], warped: NDArray[np.uint8], seeds: Seeds
) -> NDArray[np.float32] | None:
    """A flow (H, W, 2) between the seeds that keeps to the edges of the picture; None if too few.

    Revaud et al., EpicFlow: edge-preserving interpolation of correspondences for optical flow, CVPR
    2015, as OpenCV has it. Where a seed has fewer neighbours than OpenCV is told to look at, it
    reads memory that is not its own: each pixel has one seed, and no more are asked for.
    """
    height, width = first.shape[:2]
    seeds = _one_a_pixel(seeds, (height, width))
    if len(seeds) < FEWEST_STARTS:
        return None
    interpolator = cv2.ximgproc.createEdgeAwareInterpolator()
    interpolator.setK(min(NEAREST_STARTS, len(seeds)))
    interpolator.setUsePostProcessing(False)
    found: NDArray[np.float32] = interpolator.interpolate(
        first, seeds.points_1, warped, seeds.points_2
    )
    largest = np.float32(max(height, width))
    moves: NDArray[np.float32] = np.clip(np.nan_to_num(found), -largest, largest)
    return moves


def _one_a_pixel(seeds: Seeds, shape: tuple[int, int]) -> Seeds:
    """The first seed of each pixel of image 1."""
    pixels = np.clip(np.floor(seeds.points_1 + 0.5), 0, (shape[1] - 1, shape[0] - 1))
    return seeds.take(np.sort(np.unique(pixels, axis=0, return_index=True)[1]))
