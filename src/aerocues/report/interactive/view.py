"""What an interactive figure is drawn from: one entry, and the combinations to show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ArgumentError
from aerocues.report.columns import PairColumn, column_values, columns_for, matrix_positions
from aerocues.report.entry import ReportEntry

Array = NDArray[np.float64]
QUALITY = ("ref_precision@3", "precision_beyond_chance", "precision", "f1_score", "inliers")


@dataclass(frozen=True, eq=False)
class View:
    """What is shown.

    Parameters
    ----------
    entries : sequence of ReportEntry
        All that the results hold.
    found : ReportEntry
        The one that most figures are of.
    positions : (N,) int
        Combinations to show, the best first.
    top : int
        How many of them, where not all fit.
    pair : int or None
        Number of the pair whose matches are drawn; the first one otherwise.
    column : str or None
        Figure of pairs to show; a usual one otherwise.
    """

    entries: Sequence[ReportEntry]
    found: ReportEntry
    positions: NDArray[np.int64]
    top: int
    pair: int | None = None
    column: str | None = None

    @property
    def best(self) -> NDArray[np.int64]:
        """The first `top` of the combinations to show."""
        return self.positions[: self.top]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Of all combinations; arrays are in this order."""
        return self.found.combinations

    def named(self, positions: NDArray[np.int64]) -> list[str]:
        """Names of some combinations."""
        return [self.names[position] for position in positions]

    @cached_property
    def parts(self) -> list[list[str]]:
        """Detector, descriptor, norm and matcher of all combinations."""
        return [name.split("-") for name in self.names]

    @cached_property
    def pairs(self) -> list[dict[str, Any]]:
        """The pairs of images."""
        return self.found.pairs()

    @cached_property
    def _columns(self) -> dict[str, PairColumn]:
        criteria = self.found.ranking.scores.table.criteria
        return {column.name: column for column in columns_for(criteria)}

    def values(self, name: str) -> Array | None:
        """(combinations, pairs) of a figure, NaN where it is not known; None if it never is."""
        if name not in self._columns:
            known = ", ".join(self._columns)
            raise ArgumentError(f"`column` must be one of {known}, got {name!r}")
        rows = self.found.rows
        positions = matrix_positions(
            rows,
            {each: position for position, each in enumerate(self.names)},
            {pair["pair"]: position for position, pair in enumerate(self.pairs)},
        )
        shape = (len(self.names), len(self.pairs))
        return column_values(rows, self._columns[name], positions, shape, self.found.succeeded)

    def first_known(self, *names: str) -> str | None:
        """The first of some figures that was measured."""
        return next((each for each in names if self.has(each)), None)

    def has(self, name: str) -> bool:
        """Whether a figure was measured."""
        return name in self._columns and self.values(name) is not None

    def known(self, wanted: str) -> list[str]:
        """Measured figures whose name contains a text."""
        return [name for name in self._columns if wanted in name and self.has(name)]

    def means(self, name: str, *, failed_as_zero: bool = False) -> Array:
        """(combinations,) means over the pairs, NaN where nothing is known."""
        values = self.values(name)
        if values is None:
            return np.full(len(self.names), np.nan)
        if failed_as_zero:
            return np.asarray(np.nan_to_num(values).mean(axis=1))
        known = ~np.isnan(values)
        counts = known.sum(axis=1)
        sums = np.where(known, values, 0.0).sum(axis=1)
        nothing = np.full(len(counts), np.nan)
        return np.asarray(np.divide(sums, counts, out=nothing, where=counts > 0))


def label_of(name: str) -> str:
    """A name of a figure in words."""
    return name.replace("_", " ")
