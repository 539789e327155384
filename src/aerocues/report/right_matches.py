"""Which matches of a picture are right, by the ground truth or the reference of the pair."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Pair
from aerocues.datasets.true_geometry import Located
from aerocues.evaluation.depth_correspondence import DepthCorrespondence
from aerocues.evaluation.unit import Context
from aerocues.pipeline.correspondence import PlaneCorrespondence
from aerocues.pipeline.point_figures import RIGHT
from aerocues.pipeline.reference_source import ReferenceSource

if TYPE_CHECKING:
    from aerocues.methods.arrays import Float32Array
    from aerocues.pipeline.correspondence import Correspondence

TRUTH, REFERENCE = "ground truth", "reference"


class RightMatches:
    """Judges matches as a measurement does.

    Parameters
    ----------
    context : Context
        References are used where its protocol tests against chance, as in a run.
    """

    def __init__(self, context: Context) -> None:
        self._dataset = context.dataset
        tested = context.protocol.chance is not None
        self._source = ReferenceSource(context.references) if tested else None
        self._known: tuple[Pair, str | None, Correspondence | None] | None = None

    def judged(
        self, pair: Pair, points_1: Float32Array, points_2: Float32Array
    ) -> tuple[NDArray[np.bool_] | None, str | None]:
        """Whether each match is right within 3 px, and by what; None where nothing tells.

        Parameters
        ----------
        pair : Pair
        points_1, points_2 : (M, 2) float32
            Pixels of the images as read.
        """
        if self._known is None or self._known[0] is not pair:
            self._known = (pair, *self._correspondence(pair))
        _, source, correspondence = self._known
        if correspondence is None:
            return None, None
        return correspondence.errors(points_1, points_2) <= RIGHT, source

    def _correspondence(self, pair: Pair) -> tuple[str | None, Correspondence | None]:
        first, second = map(self._dataset.image, (pair.image_1, pair.image_2))
        if pair.homography is not None:
            return TRUTH, PlaneCorrespondence(pair.homography, first.read(), second.read())
        views = self._dataset.true_views(pair)
        if views is not None and all(view.depth for view in views):
            return TRUTH, DepthCorrespondence(*map(Located.of, views))
        if self._source is None:
            return None, None
        reference = self._source.reference(first, second, pair.index)
        return REFERENCE, reference.correspondence(first.read(), second.read())
