"""Resampling of repeats, jointly for all alternatives."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from aerocues.scoring.table import DecisionTable

Array = NDArray[np.float64]
Unit = Literal["block", "repeat"]
# With fewer blocks, there are hardly any different resamples.
FEWEST_BLOCKS = 5


def unit_of_resampling(table: DecisionTable) -> Unit:
    """Whole blocks if there are enough of them, else single repeats."""
    blocks = len(np.unique(table.blocks))
    return "block" if FEWEST_BLOCKS <= blocks < len(table.repeats) else "repeat"


def independent_units(table: DecisionTable) -> NDArray[np.int64]:
    """(repeats,) number of the resampling unit of each repeat, from 0."""
    if unit_of_resampling(table) == "block":
        return np.unique(table.blocks, return_inverse=True)[1].astype(np.int64)
    return np.arange(len(table.repeats), dtype=np.int64)


def draws(table: DecisionTable, resamples: int, seed: int, batch: int) -> Iterator[Array]:
    """Resamples in batches of (batch, repeats): the number of times each repeat was drawn.

    The draws depend only on the seed, not on the batch size.
    """
    units = independent_units(table)
    number = int(units.max()) + 1
    generator = np.random.default_rng(seed)
    drawn = generator.multinomial(number, np.full(number, 1 / number), size=resamples)
    for start in range(0, resamples, batch):
        yield drawn[start : start + batch][:, units].astype(np.float64)
