"""Small decision tables to score."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aerocues.scoring import Criterion, DecisionTable


def table_of(
    values: ArrayLike,
    costs: Sequence[int] = (),
    *,
    failed: NDArray[np.bool_] | None = None,
    blocks: Sequence[int] | None = None,
    names: Sequence[str] | None = None,
) -> DecisionTable:
    """A table of (alternatives, repeats, criteria) values named a0.., r0.., c0...

    NaN are failed unless `failed` says otherwise; `costs` are the positions of the costs.
    """
    array = np.asarray(values, dtype=np.float64)
    alternatives, repeats, criteria = array.shape
    return DecisionTable(
        alternatives=tuple(names or (f"a{number}" for number in range(alternatives))),
        repeats=tuple(f"r{number}" for number in range(repeats)),
        criteria=tuple(
            Criterion(f"c{number}", "lower" if number in costs else "higher")
            for number in range(criteria)
        ),
        values=array,
        failed=np.isnan(array) if failed is None else failed,
        blocks=np.zeros(repeats, dtype=np.int64) if blocks is None else np.array(blocks),
    )


def random_table(
    seed: int, alternatives: int = 8, repeats: int = 6, criteria: int = 4
) -> DecisionTable:
    """A table of seeded uniform values, every other criterion a cost, nothing failed."""
    values = np.random.default_rng(seed).uniform(size=(alternatives, repeats, criteria))
    return table_of(values, costs=range(1, criteria, 2))
