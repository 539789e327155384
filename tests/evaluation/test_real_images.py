"""On real images with ground truth: keypoints are those that ``compute`` returned."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import Dataset, Image, Pair
from aerocues.datasets.decoding import FileSource
from aerocues.evaluation.run import run
from aerocues.methods.arrays import Features, Float32Array, Keypoints
from aerocues.methods.combination import Combination
from aerocues.methods.making import make_descriptor, make_detector, make_matcher
from aerocues.methods.presets import Preset
from aerocues.methods.registry import opencv_methods
from aerocues.pipeline.clock import Clock
from aerocues.pipeline.correspondence import transfer
from aerocues.pipeline.protocol import MeasurementProtocol
from aerocues.pipeline.verification import Verifier
from tests.evaluation.inline import InlineEngine
from tests.evaluation.scenes import assert_same_rows, rows_of
from tests.methods.pictures import textured

# MSD takes seconds an image: once is enough.
DROPPING = (
    ("ORB-FREAK-HAM-BF", 0),
    ("ORB-FREAK-HAM-BF", 1),
    ("GFTT-BRIEF-HAM-BF", 0),
    ("GFTT-BRIEF-HAM-BF", 1),
    ("MSD-ORB-HAM-BF", 0),
)


def graf(shared_data: Path, pairs: int, max_width: int | None = None) -> Dataset:
    """The first pairs of a wall that is photographed from ever more aside."""
    spec = f"oxford:{shared_data / 'oxford'}"
    return open_dataset(spec, sequences=["graf"], max_pairs=pairs, max_width=max_width)


@pytest.mark.slow
def test_sift_on_graf_is_right_by_the_truth(shared_data: Path, tmp_path: Path) -> None:
    words: dict[str, Any] = {"timing": "shared", "engine": InlineEngine()}
    table = run(graf(shared_data, 1), "SIFT-SIFT-L2-BF", tmp_path / "r", **words).table()
    [row] = table.to_dicts()
    assert row["status"] == "ok"
    assert row["gt_precision@3"] > 0.7
    assert row["homography_error"] < 3
    assert row["precision"] > 0.7
    assert abs(row["precision_beyond_chance"] - row["gt_precision@3"]) < 0.15


@pytest.mark.slow
def test_exact_search_changes_no_row_of_any_method(shared_data: Path, tmp_path: Path) -> None:
    near = graf(shared_data, 1, max_width=480)
    # Each detector and each descriptor; TBMR differs from call to call.
    chosen = "ORB-*-BF,*-SIFT-L2-BF,*-BRIEF-HAM-BF,AKAZE-AKAZE-*-BF,KAZE-KAZE-*-BF,!TBMR-*"
    words: dict[str, Any] = {"combinations": chosen, "max_keypoints": 400, "workers": 1}
    tables = [
        run(near, output=tmp_path / timing, timing=timing, features=tmp_path / "kept", **words)
        for timing in ("shared", "estimated")
    ]
    shared, estimated = (rows_of(results.table()) for results in tables)
    assert len(shared) > 30
    assert_same_rows(estimated, shared)


AS_OPENCV = Preset("as_opencv", "keypoints where OpenCV has them", False, unbiased=False)


def both(pair: Pair, dataset: Dataset, text: str) -> tuple[list[Keypoints], list[Features]]:
    """Keypoints before `compute` and features after it, of both images."""
    methods, combination = opencv_methods(), Combination.parse(text)
    detector = make_detector(methods, combination.detector)
    descriptor = make_descriptor(methods, combination.descriptor)
    before, after = [], []
    for name in (pair.image_1, pair.image_2):
        image = dataset.image(name).read().bgr
        cv2.setRNGSeed(0)
        before.append(detector.read(detector.call(image)))
        cv2.setRNGSeed(0)
        after.append(descriptor.read(descriptor.call(image, descriptor.prepare(before[-1], image))))
    return before, after


def shares(
    first: Float32Array, second: Float32Array, truth: NDArray[np.float64]
) -> tuple[float, float]:
    """Share of matches that are right by the truth, and of those that are inliers."""
    right = float((np.linalg.norm(transfer(first, truth) - second, axis=1) <= 3).mean())
    verifier = Verifier(MeasurementProtocol(chance=None), "homography", Clock())
    model = verifier.verify(first, second, np.arange(len(first))).model
    return right, model.count / len(first)


@pytest.mark.slow
@pytest.mark.parametrize(("text", "position"), DROPPING)
def test_a_stale_list_of_keypoints_would_destroy_the_matches(
    shared_data: Path, tmp_path: Path, text: str, position: int
) -> None:
    both_pairs = graf(shared_data, 2, max_width=640)
    pair = both_pairs.pairs[position]
    assert pair.homography is not None
    one = Dataset(both_pairs.name, both_pairs.images, [pair], both_pairs.geometry)
    words: dict[str, Any] = {"timing": "shared", "engine": InlineEngine()}
    found = run(one, text, tmp_path / "r", preset=AS_OPENCV, **words)
    [row] = found.table().to_dicts()
    before, after = both(pair, one, text)
    assert all(len(b) > len(a) for b, a in zip(before, after, strict=True))
    matcher = make_matcher(opencv_methods(), "BF", "HAM")
    matches = matcher.read(matcher.call(*after))
    forth, back = matches.indices.T
    right = shares(after[0].keypoints.xy[forth], after[1].keypoints.xy[back], pair.homography)
    stale = shares(before[0].xy[forth], before[1].xy[back], pair.homography)
    assert row["matches"] == len(matches)
    assert row["gt_precision@3"] == pytest.approx(right[0])
    assert row["precision"] == pytest.approx(right[1], abs=0.02)
    assert right[0] > 10 * stale[0]
    assert right[0] > 0.1 if position == 0 else right[0] > 0.02
    if position == 0:
        assert right[1] > 3 * stale[1]


@pytest.mark.slow
def test_a_hundred_megapixels_stay_within_the_limit_of_memory(tmp_path: Path) -> None:
    tile = cv2.cvtColor(textured(1000, 1000, seed=8), cv2.COLOR_BGR2GRAY)
    shift = np.roll(tile, (5, 9), axis=(0, 1))
    # Not compressed, which takes longer than all the rest.
    names = ("first.pgm", "second.pgm")
    for name, part in zip(names, (tile, shift), strict=True):
        assert cv2.imwrite(str(tmp_path / name), np.tile(part, (10, 10)))
    images = [Image(name, FileSource(tmp_path / name)) for name in names]
    dataset = Dataset("huge", images, [Pair(0, *names, "huge")], "epipolar")
    words: dict[str, Any] = {"workers": 1, "memory_limit": 4, "timing": "shared"}
    table = run(dataset, "ORB-BRIEF-HAM-FLANN", tmp_path / "r", **words).table()
    [row] = table.to_dicts()
    assert row["status"] not in ("out_of_memory", "crashed", "error", "timeout"), row["message"]
    assert row["keypoints_1"] > 20_000
