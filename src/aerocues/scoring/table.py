"""A decision table: alternatives x repeats x criteria."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ScoreError
from aerocues.scoring.criteria import Criterion
from aerocues.scoring.links import Links

if TYPE_CHECKING:
    import polars as pl

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
# Sums of larger values could overflow.
LARGEST = 1e300


@dataclass(frozen=True)
class DecisionTable:
    """The input of a score.

    Attributes
    ----------
    alternatives, repeats : tuple of str
        Names; for aerocues, combinations and image pairs.
    criteria : tuple of Criterion
    values : (alternatives, repeats, criteria) float64
        NaN if there is no value.
    failed : (alternatives, repeats, criteria) bool
        Whether a measurement failed. No value and not failed means not measured.
    blocks : (repeats,) int64
        Block (scene, sequence, day) of each repeat. Repeats of one block are correlated, so that
        only whole blocks are independent.
    components : mapping of str to tuple of str
        Labels of the alternatives, one an alternative, to group them by.
    links : Links or None
        How surely repeats are linked, where that multiplies the scores.

    Raises
    ------
    ScoreError
        If shapes do not fit, values are missing, infinite or contradictory, or a name occurs twice.
    """

    alternatives: tuple[str, ...]
    repeats: tuple[str, ...]
    criteria: tuple[Criterion, ...]
    values: Array
    failed: Mask
    blocks: NDArray[np.int64]
    components: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    links: Links | None = None

    def __post_init__(self) -> None:
        names = tuple(criterion.name for criterion in self.criteria)
        for what, listed in (
            ("alternative", self.alternatives),
            ("repeat", self.repeats),
            ("criterion", names),
        ):
            if not listed:
                raise ScoreError(f"the table has no {what}; it needs at least one")
            if len(set(listed)) < len(listed):
                twice = next(name for name in listed if listed.count(name) > 1)
                raise ScoreError(f"{what} {twice!r} occurs twice in the table; keep one of them")
        shape = (len(self.alternatives), len(self.repeats), len(self.criteria))
        if self.values.shape != shape or self.failed.shape != shape:
            raise ScoreError(f"the values have the shape {self.values.shape}; give {shape}")
        if self.blocks.shape != shape[1:2]:
            raise ScoreError(f"there are {len(self.blocks)} blocks; give one for each repeat")
        for name, labels in self.components.items():
            if len(labels) != len(self.alternatives):
                raise ScoreError(f"component {name!r} has {len(labels)} labels; give one for each")
        if self.links is not None and self.links.share.shape != shape[:2]:
            raise ScoreError(f"the links have the shape {self.links.share.shape}; give {shape[:2]}")
        self._check_values()

    def _check_values(self) -> None:
        if (np.abs(self.values) > LARGEST).any():
            raise ScoreError(
                f"values are infinite or beyond {LARGEST:g}; mark them as failed, with NaN"
            )
        if (self.failed & ~np.isnan(self.values)).any():
            raise ScoreError("a failed measurement has a value; failed values must be NaN")
        known = np.count_nonzero(~np.isnan(self.values), axis=(0, 1))
        names = self.criterion_names
        empty = [names[position] for position in np.flatnonzero(known == 0)]
        if empty:
            raise ScoreError(
                f"no alternative has a value for {', '.join(empty)}; leave these criteria out"
            )

    @property
    def criterion_names(self) -> tuple[str, ...]:
        return tuple(criterion.name for criterion in self.criteria)

    @property
    def is_cost(self) -> Mask:
        """(criteria,) bool: whether lower is better."""
        return np.array([criterion.better == "lower" for criterion in self.criteria])

    @property
    def by_repeat(self) -> Mask:
        """(criteria,) bool: whether a criterion has a value per repeat, not per alternative."""
        return np.array([not criterion.reconstruction for criterion in self.criteria])

    @property
    def tried_on(self) -> Mask:
        """(alternatives, repeats) bool: whether it was measured, including failures."""
        chosen = self._of_repeats
        there = self.failed[:, :, chosen] | ~np.isnan(self.values[:, :, chosen])
        return np.asarray(there.any(axis=2))

    @property
    def succeeded_on(self) -> Mask:
        """(alternatives, repeats) bool: whether it was measured, and no criterion failed."""
        return np.asarray(self.tried_on & ~self.failed[:, :, self._of_repeats].any(axis=2))

    @property
    def tried(self) -> NDArray[np.int64]:
        """(alternatives,) number of measured repeats, including failed ones."""
        return np.asarray(self.tried_on.sum(axis=1))

    @property
    def success_rate(self) -> Array:
        """(alternatives,) share of the measured repeats in which no criterion failed."""
        return np.asarray(self.succeeded_on.sum(axis=1) / np.maximum(self.tried, 1))

    @property
    def _of_repeats(self) -> Mask:
        return self.by_repeat if self.by_repeat.any() else ~self.by_repeat

    def without_criterion(self, name: str) -> DecisionTable:
        """The table without one criterion."""
        keep = [position for position, each in enumerate(self.criterion_names) if each != name]
        return replace(
            self,
            criteria=tuple(self.criteria[position] for position in keep),
            values=self.values[:, :, keep],
            failed=self.failed[:, :, keep],
        )

    def with_alternatives(self, keep: Sequence[int] | NDArray[np.int64]) -> DecisionTable:
        """The table with only the alternatives at these indices."""
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
            links=self.links.with_alternatives(positions) if self.links else None,
        )

    def with_repeats(self, keep: Sequence[int]) -> DecisionTable:
        """The table with only the repeats at these indices."""
        positions = [int(position) for position in keep]
        return replace(
            self,
            repeats=tuple(self.repeats[position] for position in positions),
            values=self.values[:, positions],
            failed=self.failed[:, positions],
            blocks=self.blocks[positions],
            links=self.links.with_repeats(positions) if self.links else None,
        )

    @classmethod
    def from_values(
        cls,
        values: Array,
        alternatives: Sequence[str],
        criteria: Sequence[Criterion],
        repeats: Sequence[str] | None = None,
    ) -> DecisionTable:
        """A table from an array: every NaN is a failure, and every repeat is its own block.

        Parameters
        ----------
        values : (alternatives, repeats, criteria) float64
            Or (alternatives, criteria) for a single repeat.
        alternatives : sequence of str
        criteria : sequence of Criterion
        repeats : sequence of str, optional
            Numbered by default.

        Raises
        ------
        ScoreError
            See the class.
        """
        array = np.asarray(values, dtype=np.float64)
        if array.ndim == 2:
            array = array[:, None, :]
        if array.ndim != 3:
            raise ScoreError(
                f"values must have the axes alternatives, repeats, criteria; got {array.ndim} axes"
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
        """Read a table with one row per alternative and repeat.

        A row without a finite value of a criterion has failed in it; an alternative without a row
        for a repeat was not measured on it.

        Parameters
        ----------
        frame : pl.DataFrame
        alternative : str
            Column with the names of the alternatives.
        criteria : sequence of Criterion
        repeat : str, optional
            Column that identifies the repeat; without it, each alternative has one row.
        block : str, optional
            Column that identifies the block of a repeat.

        Raises
        ------
        ScoreError
            If a column is missing or not numeric, or two rows have the same alternative and repeat.
        """
        from aerocues.scoring.long_form import read_long_form

        return cls(**read_long_form(frame, alternative, criteria, repeat, block))
