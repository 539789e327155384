"""Two runs over the same images, scored together: one normalisation, paired differences."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from aerocues.arguments import check_choice
from aerocues.defaults import RESAMPLES
from aerocues.errors import ScoreError
from aerocues.scoring.across import Entry
from aerocues.scoring.bootstrap import CONFIDENCE, Bootstrap, bootstrap
from aerocues.scoring.cues import Scores, score
from aerocues.scoring.links import Links
from aerocues.scoring.resampling import independent_units
from aerocues.scoring.significance import FEWEST_UNITS, TESTS, holm, paired_error
from aerocues.scoring.table import DecisionTable

if TYPE_CHECKING:
    import polars as pl

Array = NDArray[np.float64]
IMAGES = ("sequence", "image_1", "image_2")


@dataclass(frozen=True)
class JointScores:
    """Combinations measured in two runs on the same pairs of images, scored as one table.

    Attributes
    ----------
    combinations : tuple of str
        Those that both runs measured.
    scores : Scores
        Of all combinations in the first run, then of all in the second.
    resampled : Bootstrap
        Joint resamples of the pairs of images.
    test : {"bootstrap", "wilcoxon"}
    """

    combinations: tuple[str, ...]
    scores: Scores
    resampled: Bootstrap
    test: str

    @property
    def pairs(self) -> int:
        """Number of pairs of images that both runs measured."""
        return len(self.scores.table.repeats)

    def differences(self) -> pl.DataFrame:
        """The second run against the first, the best of both runs first.

        Returns
        -------
        pl.DataFrame
            ``combination``; ``first_score, second_score`` on one scale; ``difference`` (second
            minus first) with ``difference_low, difference_high`` (95 %); ``p_value`` (two-sided,
            corrected by Holm for the number of combinations; null with fewer than 5 pairs);
            ``first_rank, second_rank`` within each run.
        """
        import polars as pl
        from scipy.special import stdtrit

        from aerocues.scoring.cues import rank

        number = len(self.combinations)
        first, second = np.arange(number), np.arange(number) + number
        by_run = self.scores.scores.reshape(2, number)
        difference = by_run[1] - by_run[0]
        shared, error = paired_error(self.scores, self.resampled, second, first)
        half = stdtrit(np.maximum(shared - 1, 1), (1 + CONFIDENCE) / 2) * error
        ranks = rank(by_run)
        p_values = TESTS[self.test](self.scores, self.resampled, second, first)
        best = np.where(np.isnan(by_run).all(axis=0), -np.inf, np.fmax(*by_run))
        return pl.DataFrame(
            {
                "combination": self.combinations,
                "first_score": by_run[0],
                "second_score": by_run[1],
                "difference": difference,
                "difference_low": difference - half,
                "difference_high": difference + half,
                "p_value": holm(p_values),
                "first_rank": ranks[0],
                "second_rank": ranks[1],
            },
            nan_to_null=True,
        ).with_columns(pl.col("first_rank", "second_rank").cast(pl.Int64))[
            np.lexsort((np.array(self.combinations), -best))
        ]

    def criteria(self) -> pl.DataFrame:
        """Each criterion over all combinations: where the difference of the runs comes from.

        Returns
        -------
        pl.DataFrame
            ``criterion`` (and ``success_rate``); ``first, second``: means over what both runs
            measured with success; ``difference``; ``better`` (``higher`` or ``lower``);
            ``p_value``: Wilcoxon's signed-rank test over the pairs of images, or over sequences
            where there are enough, corrected by Holm for the number of criteria.
        """
        import polars as pl

        table, number = self.scores.table, len(self.combinations)
        succeeded = np.where(table.tried_on, table.succeeded_on, np.nan)
        rows = [("success_rate", "higher", succeeded)]
        rows += [
            (criterion.name, criterion.better, table.values[:, :, column])
            for column, criterion in enumerate(table.criteria)
            if not criterion.reconstruction
        ]
        units = independent_units(table)
        found = [
            {
                "criterion": name,
                **_paired(values[:number], values[number:], units),
                "better": better,
            }
            for name, better, values in rows
        ]
        frame = pl.DataFrame(found, infer_schema_length=None)
        p_values = holm(frame["p_value"].cast(pl.Float64).fill_null(np.nan).to_numpy())
        return frame.with_columns(pl.Series("p_value", p_values).fill_nan(None))


def _paired(first: Array, second: Array, units: NDArray[np.int64]) -> dict[str, Any]:
    """Means over what both have, and the test of their difference over the units."""
    from scipy.stats import wilcoxon

    both = ~np.isnan(first + second)
    if not both.any():
        return dict.fromkeys(("first", "second", "difference", "p_value"))
    change = np.where(both, second - first, 0).sum(axis=0)
    of_units = np.bincount(units, change) / np.maximum(np.bincount(units, both.sum(axis=0)), 1)
    of_units = of_units[np.bincount(units, both.sum(axis=0)) > 0]
    p_value = None
    if len(of_units) >= FEWEST_UNITS:
        p_value = float(wilcoxon(of_units).pvalue) if np.any(of_units) else 1.0
    return {
        "first": float(first[both].mean()),
        "second": float(second[both].mean()),
        "difference": float((second - first)[both].mean()),
        "p_value": p_value,
    }


def score_jointly(
    first: Entry,
    second: Entry,
    *,
    test: str = "bootstrap",
    resamples: int = RESAMPLES,
    seed: int = 0,
) -> JointScores:
    """Score two runs over the same images as one table.

    Bounds and weights come from both runs, so that a difference of scores is a difference of what
    was measured. Combinations and pairs of images that only one run has are left out. Pairs are
    the same if their images have the same names.

    Parameters
    ----------
    first, second : Entry
    test : {"bootstrap", "wilcoxon"}
        As in `significance.compare_with_one`.
    resamples, seed : int
        See `bootstrap.bootstrap`.

    Raises
    ------
    ScoreError
        If they have no combination or no pair of images in common.
    """
    check_choice("test", test, TESTS)
    tables = [_of_shared_pairs(*each) for each in ((first, second), (second, first))]
    names = sorted(set(tables[0].alternatives) & set(tables[1].alternatives))
    if not names:
        raise ScoreError("the two runs share no combination, so they cannot be scored together")
    chosen = [
        table.with_alternatives([table.alternatives.index(name) for name in names])
        for table in tables
    ]
    scores = score(_stacked(*chosen), first.scores.settings)
    return JointScores(tuple(names), scores, bootstrap(scores, resamples, seed), test)


def _images_of(entry: Entry) -> Mapping[str, tuple[Any, ...]]:
    """Sequence and images of each repeat."""
    chosen = entry.rows.select("pair", *(name for name in IMAGES if name in entry.rows.columns))
    return {str(pair): images for pair, *images in map(list, chosen.unique().iter_rows())}  # type: ignore[misc]


def _of_shared_pairs(entry: Entry, other: Entry) -> DecisionTable:
    """The table of one run with the pairs that the other one has, sorted by their images."""
    images, table = _images_of(entry), entry.scores.table
    own = {tuple(images[repeat]): number for number, repeat in enumerate(table.repeats)}
    of_other = _images_of(other)
    known = {tuple(of_other[repeat]) for repeat in other.scores.table.repeats}
    shared = sorted(own.keys() & known, key=str)
    if not shared:
        raise ScoreError(
            "the two runs share no pair of images, so they cannot be scored together; measure the "
            "same images with the same pairs"
        )
    return table.with_repeats([own[each] for each in shared])


def _stacked(first: DecisionTable, second: DecisionTable) -> DecisionTable:
    """One table of both runs, whose repeats are the same."""
    links = None
    if first.links and second.links:
        links = Links(np.concatenate([first.links.share, second.links.share]), first.links.classes)
    return replace(
        first,
        alternatives=(
            *(f"{name} (first)" for name in first.alternatives),
            *(f"{name} (second)" for name in second.alternatives),
        ),
        values=np.concatenate([first.values, second.values]),
        failed=np.concatenate([first.failed, second.failed]),
        components={},
        links=links,
    )
