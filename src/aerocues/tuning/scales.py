"""Scales on which the effects of methods and pairs are additive."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
# Added before the logarithm, relative to the median: larger values treat small numbers as equal,
# smaller ones let zeros dominate.
_SMALL = 0.01


@dataclass(frozen=True, eq=False)
class Scales:
    """The transformation of each criterion: arcsine for shares, logarithm for other values.

    Parameters
    ----------
    share : (C,) bool
        Whether the values are shares, from 0 to 1.
    offset : (C,) float64
        Added before the logarithm, so that it is defined for 0.
    worst : (C,) float64
        Value that replaces a failure.
    """

    share: Mask
    offset: Array
    worst: Array

    @classmethod
    def of(cls, values: Array, is_cost: Mask) -> Scales:
        """The scales for (N, C) measured values; NaN where a measurement failed."""
        share = (np.nanmin(values, axis=0) >= 0) & (np.nanmax(values, axis=0) <= 1)
        offset = _SMALL * np.nanmedian(np.abs(values), axis=0) + np.finfo(np.float64).tiny
        worst = np.where(is_cost, np.nanmax(values, axis=0), np.nanmin(values, axis=0))
        return cls(share, offset, np.where(share & ~is_cost, 0.0, worst))

    def stretch(self, values: Array) -> Array:
        """(..., C) transformed values; failures count as the worst."""
        known = np.where(np.isnan(values), self.worst, values)
        turned = np.arcsin(np.sqrt(np.clip(known, 0.0, 1.0)))
        grown = np.log(np.maximum(known, 0.0) + self.offset)
        return np.where(self.share, turned, grown)

    def shrink(self, stretched: Array) -> Array:
        """(..., C) values from transformed ones."""
        turned = np.sin(np.clip(stretched, 0.0, np.pi / 2)) ** 2
        grown = np.exp(np.clip(stretched, -50.0, 50.0)) - self.offset
        return np.where(self.share, turned, np.maximum(grown, 0.0))
