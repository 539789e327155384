"""Compares two described images and their matches with the ground truth."""

from __future__ import annotations

from dataclasses import dataclass

from aerocues.datasets.dataset import Dataset, Pair, TrueView
from aerocues.datasets.true_geometry import Located
from aerocues.evaluation import ground_truth
from aerocues.evaluation.depth_correspondence import DepthCorrespondence
from aerocues.evaluation.relative_pose import estimate_pose, pose_error, true_pose
from aerocues.methods.arrays import Float32Array
from aerocues.pipeline.correspondence import Correspondence, PlaneCorrespondence
from aerocues.pipeline.features import Described, ImageFeatures, run_stage
from aerocues.pipeline.point_figures import PointFigures
from aerocues.pipeline.verification import IndexArray, Verifier
from aerocues.results.metrics import Row
from aerocues.results.schema import ANGLE_THRESHOLDS, PIXEL_THRESHOLDS


@dataclass(frozen=True)
class TwoViews:
    """The two images of a pair under one detector and descriptor."""

    pair: Pair
    images: tuple[ImageFeatures, ImageFeatures]
    described: tuple[Described, Described]

    @property
    def positions(self) -> tuple[Float32Array, Float32Array]:
        """Where the keypoints of both images lie, (N, 2) float32 pixels each."""
        first, second = (described.features.keypoints.xy for described in self.described)
        return first, second


@dataclass(frozen=True, eq=False)
class Matched:
    """Points of matches, (M, 2) float32 pixels each, and their order by descriptor distance."""

    points_1: Float32Array
    points_2: Float32Array
    order: IndexArray


class TruthComparison:
    """Fills the ground-truth columns of rows; does nothing without ground truth.

    Parameters
    ----------
    dataset : Dataset
    """

    def __init__(self, dataset: Dataset) -> None:
        self._dataset = dataset
        self._figures = PointFigures("gt")
        self._depth: DepthCorrespondence | None = None

    def begin_pair(self) -> None:
        """Forget the cached data of the previous pair."""
        self._figures.begin_pair()
        self._depth = None

    def compare(self, row: Row, views: TwoViews, found: Matched, verifier: Verifier) -> None:
        """Add the ground-truth metrics of matches, keypoints, homography and pose.

        The verifier estimates models in the same way as for the matches themselves.
        """
        correspondence = self._correspondence(views)
        if correspondence is not None:
            errors = correspondence.errors(found.points_1, found.points_2)
            row.update(self._figures.of(errors, views.positions, correspondence))
        if views.pair.homography is not None:
            self._compare_homography(row, views, found, verifier)
        true_views = self._dataset.true_views(views.pair)
        if true_views is not None:
            self._compare_pose(row, true_views, found, verifier)

    def _correspondence(self, views: TwoViews) -> Correspondence | None:
        pair = views.pair
        if pair.homography is not None:
            return PlaneCorrespondence(pair.homography, *(image.pixels for image in views.images))
        true_views = self._dataset.true_views(pair)
        if self._depth is None and true_views is not None and all(v.depth for v in true_views):
            what = f"reading the depths of {pair.image_1} and {pair.image_2}"
            first, second = run_stage(what, lambda: [Located.of(view) for view in true_views])
            self._depth = DepthCorrespondence(first, second)
        return self._depth

    def _compare_homography(
        self, row: Row, views: TwoViews, found: Matched, verifier: Verifier
    ) -> None:
        truth = views.pair.homography
        assert truth is not None
        model = run_stage(
            "estimating a homography",
            lambda: verifier.homography(
                found.points_1, found.points_2, found.order, row["sampling"] or "uniform"
            ),
        )
        row["homography_inliers"] = model.count
        error = ground_truth.corner_error(model.matrix, truth, views.images[0].pixels)
        row["homography_error"] = error
        for threshold in PIXEL_THRESHOLDS:
            row[f"homography_auc@{threshold}"] = ground_truth.area_under_curve(error, threshold)

    def _compare_pose(
        self, row: Row, truth: tuple[TrueView, TrueView], found: Matched, verifier: Verifier
    ) -> None:
        first, second = truth
        points_1, points_2 = found.points_1, found.points_2
        parameters, guided = verifier.pose_parameters(row["sampling"] or "uniform")
        if guided:
            points_1, points_2 = points_1[found.order], points_2[found.order]
        estimate = run_stage(
            "estimating a pose",
            lambda: estimate_pose(points_1, points_2, (first.camera, second.camera), parameters),
        )
        error = pose_error(estimate, true_pose(first, second))
        row["pose_error"] = error
        for angle in ANGLE_THRESHOLDS:
            row[f"pose_auc@{angle}"] = ground_truth.area_under_curve(error, angle)
