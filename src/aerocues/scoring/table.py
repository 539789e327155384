"""A decision table: alternatives x repeats x criteria."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ScoreError
from aerocues.scoring.criteria import Criterion

if TYPE_CHECKING:
    import polars as pl

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
# Sums of larger ones might be no numbers any more.
LARGEST = 1e300


@dataclass(frozen=True)
class DecisionTable:
    """What is to be scored.

    Attributes
    ----------
    alternatives, repeats : tuple of str
        Their names; for aerocues, combinations and image pairs.
    criteria : tuple of Criterion
    values : (alternatives, repeats, criteria) float64
        NaN where there is no value.
    failed : (alternatives, repeats, criteria) bool
        Where a measurement was tried and gave no value. No value and not failed: not measured.
    blocks : (repeats,) int64
        The block (scene, sequence, day) that each repeat belongs to. Repeats of one block are
        alike, so that only whole blocks can be taken for independent.
    components : mapping of str to tuple of str
        Labels of the alternatives, one an alternative, to group them by.

    Raises
    ------
    ScoreError
        If shapes do not fit, something is empty, infinite or contradictory, or a name comes twice.
    """

    alternatives: tuple[str, ...]
    repeats: tuple[str, ...]
    criteria: tuple[Criterion, ...]
    values: Array
    failed: Mask
    blocks: NDArray[np.int64]
    components: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        names = tuple(criterion.name for criterion in self.criteria)
        for what, listed in (
            ("alternative", self.alternatives),
            ("repeat", self.repeats),
            ("criterion", names),
        ):
            if not listed:
                raise ScoreError(f"the table has no {what}; it needs one at least")
            if len(set(listed)) < len(listed):
                twice = next(name for name in listed if listed.count(name) > 1)
                raise ScoreError(f"{what} {twice!r} comes twice in the table; keep one of them")
        shape = (len(self.alternatives), len(self.repeats), len(self.criteria))
        if self.values.shape != shape or self.failed.shape != shape:
            raise ScoreError(f"the values have the shape {self.values.shape}; give {shape}")
        if self.blocks.shape != shape[1:2]:
            raise ScoreError(f"there are {len(self.blocks)} blocks; give one for each repeat")
        for name, labels in self.components.items():
            if len(labels) != len(self.alternatives):
                raise ScoreError(f"component {name!r} has {len(labels)} labels; give one for each")
        self._check_values()

    def _check_values(self) -> None:
        if (np.abs(self.values) > LARGEST).any():
            raise ScoreError(
                f"the values hold infinities or numbers beyond {LARGEST:g}; mark them as failed, "
                "with NaN"
            )
        if (self.failed & ~np.isnan(self.values)).any():
            raise ScoreError("a value is marked as failed; put NaN where a measurement failed")
        known = np.count_nonzero(~np.isnan(self.values), axis=(0, 1))
        names = self.criterion_names
        empty = [names[position] for position in np.flatnonzero(known == 0)]
        if empty:
            raise ScoreError(
                f"there is no value at all for {', '.join(empty)}; leave such criteria out"
            )

    @property
    def criterion_names(self) -> tuple[str, ...]:
        return tuple(criterion.name for criterion in self.criteria)

    @property
    def is_cost(self) -> Mask:
        """(criteria,) bool: where lower is better."""
        return np.array([criterion.better == "lower" for criterion in self.criteria])

    @property
    def by_repeat(self) -> Mask:
        """(criteria,) bool: criteria that have a value a repeat, not one an alternative."""
        return np.array([not criterion.reconstruction for criterion in self.criteria])

    @property
    def tried(self) -> NDArray[np.int64]:
        """(alternatives,) repeats that were measured, with success or not."""
        return np.asarray(self._tried.any(axis=2).sum(axis=1))

    @property
    def success_rate(self) -> Array:
        """(alternatives,) share of the repeats tried in which no criterion failed."""
        succeeded = self._tried.any(axis=2) & ~self.failed[:, :, self._of_repeats].any(axis=2)
        return np.asarray(succeeded.sum(axis=1) / np.maximum(self.tried, 1))

    @property
    def _of_repeats(self) -> Mask:
        return self.by_repeat if self.by_repeat.any() else ~self.by_repeat

    @property
    def _tried(self) -> Mask:
        chosen = self._of_repeats
        return np.asarray(self.failed[:, :, chosen] | ~np.isnan(self.values[:, :, chosen]))

    def without_criterion(self, name: str) -> DecisionTable:
        """The same table with one criterion less."""
        keep = [position for position, each in enumerate(self.criterion_names) if each != name]
        return replace(
            self,
            criteria=tuple(self.criteria[position] for position in keep),
            values=self.values[:, :, keep],
            failed=self.failed[:, :, keep],
        )

    def with_alternatives(self, keep: Sequence[int] | NDArray[np.int64]) -> DecisionTable:
        """The same table with the alternatives at these positions only."""
        positions = [int(position) for position in keep]
        return replace(
            self,
            alternatives=tuple(self.alternatives[position] for position in positions),
            values=self.values[positions],
            failed=self.failed[positions],
            components={
                name: tuple(labels[position] for position in positions)
                for name, labels in self.components.items()
            },
        )

    @classmethod
    def from_values(
        cls,
        values: Array,
        alternatives: Sequence[str],
        criteria: Sequence[Criterion],
        repeats: Sequence[str] | None = None,
    ) -> DecisionTable:
        """A table from an array; every NaN in it is a failure, every repeat a block of its own.

        Parameters
        ----------
        values : (alternatives, repeats, criteria) float64
            Or (alternatives, criteria), where there is one repeat.
        alternatives : sequence of str
        criteria : sequence of Criterion
        repeats : sequence of str, optional
            Numbered by default.

        Raises
        ------
        ScoreError
            As for the class.
        """
        array = np.asarray(values, dtype=np.float64)
        if array.ndim == 2:
            array = array[:, None, :]
        if array.ndim != 3:
            raise ScoreError(
                f"the values have {array.ndim} axes; give alternatives, repeats, criteria"
            )
        number = array.shape[1]
        return cls(
            alternatives=tuple(alternatives),
            repeats=tuple(repeats if repeats is not None else map(str, range(number))),
            criteria=tuple(criteria),
            values=array,
            failed=np.isnan(array),
            blocks=np.arange(number, dtype=np.int64),
        )

    @classmethod
    def from_frame(
        cls,
        frame: pl.DataFrame,
        *,
        alternative: str,
        criteria: Sequence[Criterion],
        repeat: str | None = None,
        block: str | None = None,
    ) -> DecisionTable:
        """Read a table with one row an alternative and repeat.

        A row without a finite number for a criterion has failed on it; an alternative without a
        row for a repeat was not measured on it.

        Parameters
        ----------
        frame : pl.DataFrame
        alternative : str
            Column with the names of the alternatives.
        criteria : sequence of Criterion
        repeat : str, optional
            Column that tells the repeats apart; without it, each alternative has one row.
        block : str, optional
            Column that says which repeats are alike.

        Raises
        ------
        ScoreError
            If a column is missing or no number, or two rows are about the same.
        """
        from aerocues.scoring.long_form import read_long_form

        return cls(**read_long_form(frame, alternative, criteria, repeat, block))
