"""Rows before they are measured, and rows of failed work."""

from __future__ import annotations

import json
import time

import cv2

from aerocues.datasets.dataset import Pair
from aerocues.evaluation.unit import Context, Unit
from aerocues.methods.combination import Combination
from aerocues.phrases import printable
from aerocues.results.metrics import Row
from aerocues.results.schema import ANGLE_THRESHOLDS, PIXEL_THRESHOLDS, empty_row


def begin_row(context: Context, pair: Pair, combination: Combination, key: str) -> Row:
    """A row with its identity and provenance; all other values are unknown."""
    row = empty_row()
    row.update(
        dataset=context.dataset.name,
        sequence=pair.sequence,
        pair=pair.index,
        image_1=pair.image_1,
        image_2=pair.image_2,
        detector=combination.detector,
        descriptor=combination.descriptor,
        norm=combination.norm,
        matcher=combination.matcher,
        preset=context.preset,
        turned_1=context.dataset.image(pair.image_1).turn,
        turned_2=context.dataset.image(pair.image_2).turn,
        parameters=json.dumps(context.methods.parameters(combination), sort_keys=True),
        max_keypoints=context.protocol.limit.count,
        keypoint_choice="spread" if context.protocol.limit.spread else "strongest",
        inlier_threshold=context.protocol.threshold(combination),
        opencv_version=cv2.__version__,
        machine=context.machine,
        seed=context.protocol.seed,
        timing=context.protocol.timing,
        settings_key=context.settings_key,
        row_key=key,
        measured_at=time.time(),
    )
    if pair.homography is not None:
        # Without a homography the error is infinite: a failed pair counts in the mean.
        row["homography_error"] = float("inf")
        row.update({f"homography_auc@{threshold}": 0.0 for threshold in PIXEL_THRESHOLDS})
    if context.dataset.true_views(pair) is not None:
        row["pose_error"] = float("inf")
        row.update({f"pose_auc@{angle}": 0.0 for angle in ANGLE_THRESHOLDS})
    return row


def failed_rows(context: Context, unit: Unit, status: str, message: str) -> list[Row]:
    """Rows for work that failed."""
    return [
        begin_row(context, context.dataset.pair(work.pair), combination, key)
        | {"status": status, "message": printable(message)}
        for work in unit.work
        for combination, key in zip(work.combinations, work.row_keys, strict=True)
    ]
