"""Nearest neighbours in both directions under the Euclidean norm, by products of matrices.

With ``|a - b|^2 = |a|^2 + |b|^2 - 2 ab`` a table of squared distances is one product of matrices,
several times faster than the differences that OpenCV sums up, but rounded otherwise. What the
rounding of either can hide is bounded, for any order of summation (Higham, Accuracy and Stability
of Numerical Algorithms, 2nd edition, chapter 3); whoever is within the bound of the smallest is a
candidate, and OpenCV's own distances decide among candidates.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from aerocues.compiled import compiled
from aerocues.methods.arrays import DescriptorArray, Float32Array, Int32Array
from aerocues.methods.exact.brute_force import euclidean_distances

Float64Array = NDArray[np.float64]
Indices = NDArray[np.intp]

# Rows and columns of the table that are looked at together: it stays in the cache.
TILE = 512
ROUNDING = 2.0**-24
"""The largest relative error of one operation on float32."""

# Squared lengths beyond these overflow, or lose more to underflow than the bound covers.
SHORTEST, LONGEST = 1e-20, 1e30
# Candidates a row, on average, from which on a search by candidates does not pay.
MOST_CANDIDATES = 32


@compiled
def _note(
    table: Float32Array,
    rows: Indices,
    columns: Indices,
    limits: Float32Array,
    origin: tuple[int, int],
    places: Int32Array,
    values: Float32Array,
    count: int,
) -> int:
    """Write down what is within its limit in some rows and columns of a table.

    Parameters
    ----------
    table, limits : (R, C) float32
    rows, columns : (r,) and (c,) int
    origin : (int, int)
        Is added to places.
    places, values : (P, 2) int32 and (P,) float32
        Where `count` places are written already.

    Returns
    -------
    int
        How many places are written now, P + 1 if there was no room for all.
    """
    for row in rows:
        for column in columns:
            if table[row, column] <= limits[row, column]:
                if count == len(values):
                    return count + 1
                places[count, 0] = origin[0] + row
                places[count, 1] = origin[1] + column
                values[count] = table[row, column]
                count += 1
    return count


class _Contest:
    """Finds who may be the nearest of each row of the table, or of each column, tile by tile.

    Parameters
    ----------
    axis : int
        0 for rows, 1 for columns.
    error : (N,) float64
        How far a squared distance of each row may be from the one in the table.
    growth : float
        OpenCV tells two squared distances apart if their ratio is larger.
    """

    def __init__(self, axis: int, error: Float64Array, growth: float) -> None:
        self._axis = axis
        self._margin = (2.0 * error).astype(np.float32)
        self._growth = np.float32(growth)
        self._smallest = np.full(len(error), np.inf, np.float32)
        self._limit = np.full(len(error), np.inf, np.float32)
        self._places = np.empty((MOST_CANDIDATES * len(error), 2), np.int32)
        self._values = np.empty(len(self._places), np.float32)
        self._count = 0

    def enter(self, tile: Float32Array, origin: tuple[int, int]) -> bool:
        """Take note of the candidates in the tile that begins at `origin`; False if too many."""
        smallest = tile.min(axis=1 - self._axis)
        start = origin[self._axis]
        limits = self._limit[start : start + len(smallest)]
        near = np.flatnonzero(smallest <= limits)
        if not len(near):
            return True
        own = near + start
        self._smallest[own] = np.minimum(self._smallest[own], smallest[near])
        limits[near] = self._smallest[own] * self._growth + self._margin[own]
        rows, columns = (np.arange(size) for size in tile.shape)
        rows, columns = (near, columns) if self._axis == 0 else (rows, near)
        each = np.broadcast_to(np.expand_dims(limits, 1 - self._axis), tile.shape)
        self._count = _note(
            tile, rows, columns, each, origin, self._places, self._values, self._count
        )
        return self._count <= len(self._values)

    def decide(self, first: DescriptorArray, second: DescriptorArray) -> NDArray[np.int32]:
        """The nearest of each row of the table, or of each column; of equals the first."""
        places, values = self._places[: self._count], self._values[: self._count]
        places = places[values <= self._limit[places[:, self._axis]]]
        own, other = places[:, self._axis], places[:, 1 - self._axis]
        contested = np.bincount(own)[own] > 1
        distances = np.zeros(len(own), np.float32)
        distances[contested] = euclidean_distances(first, second, *places[contested].T)
        order = np.lexsort((other, distances, own))
        _, winners = np.unique(own[order], return_index=True)
        nearest: NDArray[np.int32] = other[order[winners]]
        return nearest


def pays(rows: int, columns: int, numbers: int) -> bool:
    """Whether `nearest_both_ways` takes less time than OpenCV, by sizes of the table and of rows.

    Fitted to measured times: OpenCV's grows with the places of the table, that of this way with
    its rows and columns at first.
    """
    return rows * columns * (numbers + 20) > 1_500_000 + 12 * (rows + columns) * (numbers + 100)


def nearest_both_ways(
    first: DescriptorArray, second: DescriptorArray
) -> tuple[Int32Array, Int32Array] | None:
    """The nearest of each row of `first`, and of each row of `second`; of equals the first.

    Parameters
    ----------
    first, second : (N, D) and (M, D) uint8 or float32
        N and M at least 1.

    Returns
    -------
    forth : (N,) int
        Rows of `second`.
    back : (M,) int
        Rows of `first`.
    None
        Where that is not the way to find them: numbers are too large or too small for squares in
        float32, or not finite, or very many distances are all but equal.
    """
    lengths = _squared_lengths(first), _squared_lengths(second)
    if not all(SHORTEST < squares.max() < LONGEST for squares in lengths):
        return None
    columns = first.shape[1]
    growth = 1.0 + 1.1 * (2 * columns + 16) * ROUNDING
    contests = [
        _Contest(axis, _error(lengths[axis], lengths[1 - axis], columns), growth) for axis in (0, 1)
    ]
    if not _hold(contests, first, second, lengths):
        return None
    forth, back = (contest.decide(first, second) for contest in contests)
    return forth, back


def _hold(
    contests: list[_Contest],
    first: DescriptorArray,
    second: DescriptorArray,
    lengths: tuple[Float64Array, Float64Array],
) -> bool:
    """Go through the table once, for both directions; False if there are too many candidates."""
    left = _augmented(first, lengths[0])
    buffer = np.empty(TILE * TILE, np.float32)
    for column in range(0, len(second), TILE):
        part = slice(column, column + TILE)
        right = _augmented(second[part], lengths[1][part])
        # (a, |a|^2, 1) (-2 b, 1, |b|^2)
        right[:, :-2] *= -2.0
        right[:, -2:] = right[:, :-3:-1]
        for row in range(0, len(first), TILE):
            rows = left[row : row + TILE]
            table = buffer[: len(rows) * len(right)].reshape(len(rows), len(right))
            np.matmul(rows, right.T, out=table)
            if not all(contest.enter(table, (row, column)) for contest in contests):
                return False
    return True


def _squared_lengths(descriptors: DescriptorArray) -> Float64Array:
    lengths: Float64Array = np.einsum("ij,ij->i", descriptors, descriptors, dtype=np.float64)
    return lengths


def _augmented(descriptors: DescriptorArray, squared_lengths: Float64Array) -> Float32Array:
    """Descriptors with two more columns: their squared lengths and ones."""
    count, columns = descriptors.shape
    augmented = np.ones((count, columns + 2), np.float32)
    augmented[:, :columns] = descriptors
    augmented[:, columns] = squared_lengths
    return augmented


def _error(own: Float64Array, other: Float64Array, columns: int) -> Float64Array:
    """How far the table is from the squared distance of a row to any of the others, at most.

    A scalar product of n numbers is off by less than 1.1 n roundings of the sum of their
    magnitudes, which here is at most (|a| + |b|)^2; the squared lengths have one more each. The
    rest is room for the roundings of the bound itself.
    """
    error: Float64Array = (np.sqrt(own) + np.sqrt(other.max())) ** 2
    return 1.25 * (columns + 8) * ROUNDING * error
