"""Nearest neighbours in both directions under the Hamming norm, by counting bits in one sweep."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.compiled import compiled, numba
from aerocues.methods.arrays import Float32Array, Int32Array

Words = NDArray[np.uint32]
Keys = NDArray[np.uint64]

WORD_BYTES = 4
# Words that a sweep counts in one go, at most: those of both descriptors stay in registers.
LONGEST_GROUP = 8
# Second descriptors that a sweep keeps at hand: 256 of 64 bytes fill half of the nearest cache.
BLOCK = 256
# Distances and indices share the 32 bits of a key, in halves.
LONGEST_DESCRIPTOR = 65535 // 8
ROWS_AT_ONCE = 65536


def _typed_bit_count(typing_context: Any, word: Any) -> Any:
    """Tell numba how to count the bits of a word: by one instruction, where there is one."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.ctpop(arguments[0])

    return numba.types.uint32(numba.types.uint32), generate


_bit_count: Any = numba.extending.intrinsic(_typed_bit_count)


@cache
def _sweep_of(group: int) -> Callable[..., None]:
    """The sweep over descriptors whose number of words is a multiple of `group`.

    The number is a constant of the machine code: only then are the words of a descriptor counted
    without a loop, for as many columns at once as the processor's registers hold.
    """

    @compiled
    def sweep(rows: Words, blocks: Words, row_keys: Keys, column_keys: Words, count: int) -> None:
        """Lower the keys of rows and columns to those of their nearest.

        Parameters
        ----------
        rows : (N, W) uint32
            N at most `ROWS_AT_ONCE`.
        blocks : (B, W, C) uint32
            The second descriptors, word by word.
        row_keys : (N,) uint64
            Distance in the upper half, column in the lower.
        column_keys : (B, C) uint32
            Distance in the upper half, row in the lower.
        count : int
            How many columns there are; the rest of the last block is none.
        """
        width = blocks.shape[2]
        last = rows.shape[1] - group
        half = np.uint32(16)
        so_far = np.zeros(width, np.uint32)
        for block in range(len(blocks)):
            keys = column_keys[block]
            filled = min(width, count - block * width)
            for row in range(len(rows)):
                for word in range(0, last, group):
                    for column in range(filled):
                        bits = so_far[column] if word else np.uint32(0)
                        for i in range(group):
                            differing = rows[row, word + i] ^ blocks[block, word + i, column]
                            bits = np.uint32(bits + _bit_count(differing))
                        so_far[column] = bits
                nearest = np.uint32(0xFFFFFFFF)
                for column in range(filled):
                    bits = so_far[column]
                    for i in range(group):
                        differing = rows[row, last + i] ^ blocks[block, last + i, column]
                        bits = np.uint32(bits + _bit_count(differing))
                    distance = np.uint32(bits << half)
                    nearest = min(nearest, np.uint32(distance | np.uint32(column)))
                    keys[column] = min(keys[column], np.uint32(distance | np.uint32(row)))
                index = np.uint64(block * width) + np.uint64(nearest & np.uint32(0xFFFF))
                key = np.uint64(nearest >> half) << np.uint64(32) | index
                row_keys[row] = min(row_keys[row], key)

    return sweep


def nearest_both_ways(
    first: NDArray[np.uint8], second: NDArray[np.uint8]
) -> tuple[Float32Array, Int32Array, Int32Array]:
    """The nearest of each row of `first`, and of each row of `second`; of equals the first.

    Parameters
    ----------
    first, second : (N, D) and (M, D) uint8
        D at most `LONGEST_DESCRIPTOR`; N and M at least 1.

    Returns
    -------
    distances : (N,) float32
        Bits that differ between each row of `first` and its nearest.
    forth : (N,) int32
        Rows of `second`.
    back : (M,) int32
        Rows of `first`.
    """
    words = -(-first.shape[1] // WORD_BYTES)
    groups = -(-words // LONGEST_GROUP)
    group = -(-words // groups)
    rows, columns = (_as_words(descriptors, group * groups) for descriptors in (first, second))
    blocks = _in_blocks(columns)
    row_keys = np.full(len(rows), np.iinfo(np.uint64).max, np.uint64)
    column_keys = np.full(len(columns), np.iinfo(np.uint64).max, np.uint64)
    for start in range(0, len(rows), ROWS_AT_ONCE):
        part = slice(start, start + ROWS_AT_ONCE)
        keys = np.full((len(blocks), BLOCK), np.iinfo(np.uint32).max, np.uint32)
        _sweep_of(group)(rows[part], blocks, row_keys[part], keys, len(columns))
        found = keys.ravel()[: len(columns)].astype(np.uint64)
        bits, row = found >> np.uint64(16), found & np.uint64(0xFFFF)
        np.minimum(column_keys, bits << np.uint64(32) | row + np.uint64(start), out=column_keys)
    distances = (row_keys >> np.uint64(32)).astype(np.float32)
    forth, back = (
        (keys & np.uint64(0xFFFFFFFF)).astype(np.int32) for keys in (row_keys, column_keys)
    )
    return distances, forth, back


def _as_words(descriptors: NDArray[np.uint8], words: int) -> Words:
    """Descriptors as words, with zeros, which differ in nothing, after the last byte."""
    padded = np.zeros((len(descriptors), words * WORD_BYTES), np.uint8)
    padded[:, : descriptors.shape[1]] = descriptors
    return padded.view(np.uint32)


def _in_blocks(columns: Words) -> Words:
    """Descriptors in blocks (B, W, C), so that the same word of neighbours lies side by side."""
    count, words = columns.shape
    padded = np.zeros((-(-count // BLOCK), BLOCK, words), np.uint32)
    padded.reshape(-1, words)[:count] = columns
    return np.ascontiguousarray(padded.transpose(0, 2, 1))
