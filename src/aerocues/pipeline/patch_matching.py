"""Least-squares matching: where a patch of one image lies in another one, to a part of a pixel.

Ackermann, Digital image correlation: performance and potential application in photogrammetry,
Photogrammetric Record 1984; in the inverse compositional form of Baker and Matthews,
Lucas-Kanade 20 years on: a unifying framework, IJCV 2004.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.compiled import compiled

Floats = NDArray[np.float64]
Gray = NDArray[np.float32]

# Contrast below which a patch has nothing to hold on to, in gray values.
LEAST_CONTRAST = 1.0
# What is so unlike after so many steps does not become alike any more.
STEPS_BEFORE_GIVING_UP = 5
UNLIKE = 0.4
# A step that is shorter, in pixels, is the last one.
SMALL_STEP = 0.003
# Farther than this nothing is looked for, in pixels.
FARTHEST = 10.0


def gaussian_weights(half: int, sigma: float) -> Floats:
    """Weights of the pixels of a patch, (2 half + 1, 2 half + 1); their sum is 1."""
    along = np.exp(-(np.arange(-half, half + 1) ** 2) / (2 * sigma**2))
    weights = np.outer(along, along)
    return np.asarray(weights / weights.sum(), np.float64)


@compiled
def _sampled(image: Gray, x: float, y: float) -> float:
    """The gray value between four pixels; `x` and `y` must lie inside."""
    column, row = int(x), int(y)
    right, down = x - column, y - row
    above = image[row, column] * (1 - right) + image[row, column + 1] * right
    below = image[row + 1, column] * (1 - right) + image[row + 1, column + 1] * right
    return float(above * (1 - down) + below * down)


@compiled
def _normalised(patch: Floats, weights: Floats) -> float:
    """Take mean and contrast out of a patch, in place; its contrast, 0 where it has none."""
    mean = (weights * patch).sum()
    patch -= mean
    contrast = float(np.sqrt((weights * patch * patch).sum()))
    if contrast < LEAST_CONTRAST:
        return 0.0
    patch /= contrast
    return contrast


@compiled
def _template(
    image: Gray, x: float, y: float, weights: Floats, patch: Floats, slopes: Floats
) -> bool:
    """The patch around a point, and its slopes free of gain and bias; False where there is none."""
    size = len(weights)
    left, top = x - size // 2, y - size // 2
    if left < 2 or top < 2 or left + size > image.shape[1] - 3 or top + size > image.shape[0] - 3:
        return False
    around = np.empty((size + 2, size + 2))
    for row in range(size + 2):
        for column in range(size + 2):
            around[row, column] = _sampled(image, left + column - 1, top + row - 1)
    patch[:] = around[1:-1, 1:-1]
    slopes[0] = 0.5 * (around[1:-1, 2:] - around[1:-1, :-2])
    slopes[1] = 0.5 * (around[2:, 1:-1] - around[:-2, 1:-1])
    contrast = _normalised(patch, weights)
    if contrast == 0:
        return False
    for axis in range(2):
        slopes[axis] /= contrast
        slopes[axis] -= (weights * slopes[axis]).sum()
        slopes[axis] -= patch * (weights * slopes[axis] * patch).sum()
    return True


@compiled
def _warped(image: Gray, x: float, y: float, warp: Floats, patch: Floats) -> bool:
    """The patch around a point as the warp shows it; False where it leaves the image."""
    half = len(patch) // 2
    reach_x = half * (abs(warp[0, 0]) + abs(warp[0, 1]))
    reach_y = half * (abs(warp[1, 0]) + abs(warp[1, 1]))
    if not (
        x - reach_x >= 1
        and y - reach_y >= 1
        and x + reach_x < image.shape[1] - 2
        and y + reach_y < image.shape[0] - 2
    ):
        return False
    for row in range(len(patch)):
        for column in range(len(patch)):
            u, v = column - half, row - half
            patch[row, column] = _sampled(
                image, x + warp[0, 0] * u + warp[0, 1] * v, y + warp[1, 0] * u + warp[1, 1] * v
            )
    return True


@compiled
def match_patches(
    first: Gray,
    second: Gray,
    points: Floats,
    starts: Floats,
    warps: Floats,
    weights: Floats,
    steps: int,
) -> tuple[Floats, Floats]:
    """Where patches of the first image lie in the second one.

    Parameters
    ----------
    first, second : (H, W) float32
        Slightly blurred gray values.
    points, starts : (N, 2) float64
        Centres of the patches in the first image, and about where they lie in the second one; the
        centre of the top-left pixel is (0, 0).
    warps : (N, 2, 2) float64
        What turns steps in the first image into steps in the second one around each point.
    weights : (S, S) float64
        Of the pixels of a patch, with the sum 1; S is odd.
    steps : int
        Gauss-Newton steps at most.

    Returns
    -------
    shifts : (N, 2) float64
        From `starts` to where the patches lie, in pixels of the second image.
    likeness : (N,) float64
        Zero-mean normalised cross-correlation there; -1 where a patch leaves an image or has no
        contrast.
    """
    count, size = len(points), len(weights)
    shifts, likeness = np.zeros((count, 2)), np.full(count, -1.0)
    patch, seen, slopes = np.empty((size, size)), np.empty((size, size)), np.empty((2, size, size))
    for number in range(count):
        warp, shift = warps[number], shifts[number]
        if not _template(first, points[number, 0], points[number, 1], weights, patch, slopes):
            continue
        xx = (weights * slopes[0] * slopes[0]).sum()
        xy = (weights * slopes[0] * slopes[1]).sum()
        yy = (weights * slopes[1] * slopes[1]).sum()
        determinant = xx * yy - xy * xy
        if determinant <= 0:
            continue
        last = steps
        for step in range(steps + 1):
            x, y = starts[number, 0] + shift[0], starts[number, 1] + shift[1]
            if not _warped(second, x, y, warp, seen) or _normalised(seen, weights) == 0:
                likeness[number] = -1
                break
            likeness[number] = (weights * seen * patch).sum()
            if step >= last or (step == STEPS_BEFORE_GIVING_UP and likeness[number] < UNLIKE):
                break
            seen -= patch
            along = (weights * slopes[0] * seen).sum()
            down = (weights * slopes[1] * seen).sum()
            u = (yy * along - xy * down) / determinant
            v = (xx * down - xy * along) / determinant
            shift[0] -= warp[0, 0] * u + warp[0, 1] * v
            shift[1] -= warp[1, 0] * u + warp[1, 1] * v
            small = u * u + v * v < SMALL_STEP * SMALL_STEP
            if small or shift[0] * shift[0] + shift[1] * shift[1] > FARTHEST * FARTHEST:
                last = step + 1
    return shifts, likeness


def as_gray(image: NDArray[np.uint8], blur: float) -> Gray:
    """Slightly blurred gray values of a BGR or gray image, (H, W) float32."""
    import cv2

    gray: Any = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    return np.asarray(cv2.GaussianBlur(gray.astype(np.float32), (0, 0), blur), np.float32)
