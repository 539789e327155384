"""Right matches and CPU seconds of methods on pairs of a simulated flight: upright and turned ones.

    python pairs_with_truth.py FLIGHT PAIRS [--combinations A,B] [--max-keypoints N]

Prints a line for each pair and combination, as soon as it is measured: matches, those that lie
within 3 pixels of the truth, inliers, and the seconds of both images and of the matcher. Calls are
made twice, and the second one is timed. `docs/learned.md` shows what it found in the first strip,
and across two strips, of the flight that ``aerocues simulate -o FLIGHT --survey nadir.json --seed
4101`` makes of ``{"north": 60, "east": 60, "altitude": 100, "front": 0.75}``.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

from aerocues import Pipeline, open_dataset
from aerocues.datasets.dataset import Dataset, Image, Pair
from aerocues.datasets.true_geometry import Located
from aerocues.evaluation.depth_correspondence import DepthCorrespondence

LEARNED = (
    *("XFEAT-XFEAT-L2-EXACT", "XFEAT-XFEAT-L2-LIGHTERGLUE"),
    *("ALIKED_T16-ALIKED_T16-L2-EXACT", "ALIKED_N16ROT-ALIKED_N16ROT-L2-EXACT"),
)
CLASSIC = ("SIFT-SIFT-L2-EXACT", "ORB-BEBLID-HAM-EXACT", "STAR-BRISK-HAM-EXACT")
NEAR = 3.0
Result = TypeVar("Result")


def timed(call: Callable[[], Result]) -> tuple[Result, float]:
    """What a call returns the second time, and its CPU seconds."""
    call()
    start = time.thread_time()
    result = call()
    return result, time.thread_time() - start


def truth_of(dataset: Dataset, pair: Pair) -> DepthCorrespondence:
    """What maps points of one image of a pair to the other."""
    views = dataset.true_views(pair)
    assert views is not None, f"{dataset.name} has no ground truth"
    first, second = map(Located.of, views)
    return DepthCorrespondence(first, second)


def measure(combination: str, limit: int, dataset: Dataset, pairs: list[Pair]) -> None:
    """Print the lines of one combination."""
    pipeline = Pipeline(combination, max_keypoints=limit)
    by_name: dict[str, Image] = {image.name: image for image in dataset.images}
    features: dict[str, tuple[Any, float]] = {}
    for pair in pairs:
        names = [str(pair.image_1), str(pair.image_2)]
        for name in names:
            if name not in features:
                image = by_name[name]
                features[name] = timed(lambda image=image: pipeline.features(image))
        (first, seconds_1), (second, seconds_2) = (features[name] for name in names)
        matches, seconds = timed(lambda first=first, second=second: pipeline.match(first, second))
        inliers = pipeline.verify(first, second, matches).model.inliers
        points = [
            each.keypoints.xy[matches.indices[:, column]]
            for column, each in enumerate((first, second))
        ]
        right = int((np.asarray(truth_of(dataset, pair).errors(*points)) <= NEAR).sum())
        shown = (
            " and ".join(names),
            combination,
            f"{len(first)}, {len(second)}",
            len(matches),
            right,
            int(np.sum(inliers)),
            f"{(seconds_1 + seconds_2) / 2:.2f}",
            f"{seconds:.2f}",
        )
        print("|", " | ".join(map(str, shown)), "|", flush=True)


def main() -> None:
    """Read the arguments and measure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("flight")
    parser.add_argument("pairs", help="a file with two names of images a line")
    parser.add_argument("--combinations", default=",".join((*LEARNED, *CLASSIC)))
    parser.add_argument("--max-keypoints", type=int, default=2000)
    asked = parser.parse_args()
    dataset = open_dataset(f"simulated:{asked.flight}", pairs=asked.pairs)
    for combination in asked.combinations.split(","):
        measure(combination, asked.max_keypoints, dataset, list(dataset.pairs))


if __name__ == "__main__":
    main()
