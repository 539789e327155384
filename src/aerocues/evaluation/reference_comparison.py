"""What the reference of two images says of them and of their matches."""

from __future__ import annotations

from aerocues.datasets.dataset import Dataset, Pair
from aerocues.evaluation.truth_comparison import Matched, TwoViews
from aerocues.pipeline.point_figures import RIGHT, PointFigures, coverage
from aerocues.pipeline.reference import Reference
from aerocues.pipeline.reference_source import ReferenceSource
from aerocues.pipeline.verification import Model
from aerocues.results.metrics import Row


class ReferenceComparison:
    """Fills what follows from references into rows.

    Parameters
    ----------
    dataset : Dataset
    source : ReferenceSource
    right_share : float
        See `ChanceTest`.
    """

    def __init__(self, dataset: Dataset, source: ReferenceSource, right_share: float) -> None:
        self._dataset = dataset
        self._source = source
        self._right_share = right_share
        self._figures = PointFigures("ref")
        self._reference = Reference("no pair was begun")

    def begin_pair(self, pair: Pair) -> None:
        """Find the reference of a pair."""
        self._figures.begin_pair()
        first, second = map(self._dataset.image, (pair.image_1, pair.image_2))
        self._reference = self._source.reference(first, second, pair.index)

    def describe_pair(self, row: Row) -> None:
        """Enter what is the same in all rows of the pair."""
        row["reference"] = self._reference.verdict
        row["reference_agreement"] = self._reference.agreement
        row["reference_turn"] = self._reference.turn

    def compare(self, row: Row, views: TwoViews, found: Matched, model: Model | None) -> bool:
        """Add figures of matches and keypoints.

        Returns
        -------
        bool
            Whether the reference denies the model that the matches gave.
        """
        first, second = (image.pixels for image in views.images)
        correspondence = self._reference.correspondence(first, second)
        if correspondence is None:
            return False
        errors = correspondence.errors(found.points_1, found.points_2)
        row.update(self._figures.of(errors, views.positions, correspondence))
        right = errors <= RIGHT
        row["coverage"] = coverage(found.points_1[right], first.bgr.shape)
        if model is None or model.matrix is None:
            return False
        return bool((right & model.inliers).sum() < self._right_share * model.count)
