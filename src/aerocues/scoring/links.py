"""How surely pairs of images are linked, class by class: what no mean over all pairs may hide."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ScoreError

Array = NDArray[np.float64]
ENOUGH = 60.0
"""Right matches that make a pair a sure link: more add nothing to it."""
FLOOR = 0.05
"""What is left of a score where no pair of a class is linked: the other classes still count."""


@dataclass(frozen=True, eq=False)
class Links:
    """How surely each alternative links each repeat, and the class of each repeat.

    Strips of a flight that a drone flies back are turned by 180 degrees, and few of all pairs join
    them. An alternative that links none of these loses half of the images, however well it does
    on all others. On ten flights the product of the classes, times coverage, chose the best model
    on nine (mean regret .006; means over pairs .04 to .19); docs/recommend.md tells what it is
    multiplied by since, and what that gains.

    Parameters
    ----------
    share : (alternatives, repeats) float64
        min(1, right matches / `ENOUGH`); 0 where an alternative failed, NaN where it was not
        measured.
    classes : (repeats,) int64
        Number of the class of each repeat.

    Raises
    ------
    ScoreError
        If the shapes do not fit.
    """

    share: Array
    classes: NDArray[np.int64]

    def __post_init__(self) -> None:
        if self.share.ndim != 2 or self.classes.shape != self.share.shape[1:]:
            raise ScoreError(
                f"links have the shape {self.share.shape} and {len(self.classes)} classes; give "
                "one class for each repeat"
            )

    def with_alternatives(self, positions: list[int]) -> Links:
        """The links of some alternatives."""
        return replace(self, share=self.share[positions])

    def with_repeats(self, positions: list[int]) -> Links:
        """The links of some repeats."""
        return replace(self, share=self.share[:, positions], classes=self.classes[positions])

    def factor(self, counts: Array) -> Array:
        """Product over the classes of the mean link, brought to at most 1.

        Parameters
        ----------
        counts : (batch, repeats) float64
            How often each repeat was drawn.

        Returns
        -------
        (batch, alternatives) float64
            Product of (`FLOOR` + mean share) / (`FLOOR` + 1) over the classes that were drawn and
            measured.
        """
        known = ~np.isnan(self.share)
        share = np.where(known, self.share, 0.0)
        result = np.ones((len(counts), len(share)))
        for number in np.unique(self.classes):
            own = np.where(self.classes == number, counts, 0.0)
            measured = own @ known.T
            mean = np.divide(own @ share.T, measured, out=np.ones_like(result), where=measured > 0)
            result *= (FLOOR + mean) / (FLOOR + 1.0)
        return result
