"""What a reference says of matches against what ground truth says: the table of docs/agreement.md.

    python benchmarks/agreement.py WORK

Three simulated flights, the Oxford sequences and two of HPatches (AEROCUES_SHARED_DATA), 66
combinations with the strongest 3,000 keypoints of an image. A row a pair: Spearman's correlation
of the precisions of the combinations, once of the reference with the truth (within 3 px) and once
of inliers beyond chance with the truth, and the mean differences. Interrupted, it goes on. Takes
about 15 minutes of one core.
"""

from __future__ import annotations

import math
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import polars as pl
from scipy.stats import spearmanr

import aerocues
from aerocues.datasets.dataset import Dataset, Pair
from aerocues.pipeline.features import read_inner
from aerocues.pipeline.point_figures import coverage
from aerocues.pipeline.reference import FLOW, ReferenceBuilder

DETECTORS = "AGAST,AKAZE,BRISK,FAST,GFTT,GFTT_H,KAZE,MSER,ORB,SIFT,STAR"
DESCRIBED = ("SIFT-L2", "DAISY-L2", "BEBLID-HAM", "BRISK-HAM", "BRIEF-HAM", "FREAK-HAM")
KEYPOINTS, REPEATS = 3000, 20
TRUTH, REFERENCE, INLIERS = "gt_precision@3", "ref_precision@3", "precision_beyond_chance"
FLIGHTS = {
    "nadir": ("suburb", 4101, 3, '{"north": 60, "east": 60, "altitude": 100, "front": 0.75}'),
    "oblique": (
        *("industrial", 4102, 4),
        '{"pattern": "oblique", "north": 60, "east": 60, "altitude": 90}',
    ),
    "sixty": (
        *("suburb", 4103, 4),
        '{"north": 40, "east": 40, "altitude": 60, "front": 0.75, "side": 0.65}',
    ),
}
"""Scene, seed, number of pairs (the last one across strips) and mission of each."""
PLANES = ("oxford", "hpatches")
SECOND_IMAGES = (2, 4)


def datasets(work: Path) -> Iterator[Dataset]:
    """The first pairs of the flights, and two pairs of each sequence of planes."""
    for name, (scene, seed, pairs, mission) in FLIGHTS.items():
        survey, flight = work / f"{name}.json", work / name
        survey.write_text(mission)
        words = ("simulate", "--survey", survey, "--scene", scene, "--seed", seed, "-o", flight)
        subprocess.run([sys.executable, "-m", "aerocues", *map(str, words)], check=True)
        yield aerocues.open_dataset(f"simulated:{flight}", max_pairs=pairs)
    data = Path(os.environ.get("AEROCUES_SHARED_DATA", "../shared/data"))
    for kind in PLANES:
        whole = aerocues.open_dataset(f"{kind}:{data / kind}")
        chosen = [pair for pair in whole.pairs if number(pair.image_2) in SECOND_IMAGES]
        used = {name for pair in chosen for name in (pair.image_1, pair.image_2)}
        images = [image for image in whole.images if image.name in used]
        yield replace(whole, pairs=chosen, images=images)


def measured(dataset: Dataset, work: Path) -> pl.DataFrame:
    """The rows of all combinations on all pairs."""
    chosen = ",".join(f"*-{name}-EXACT" for name in DESCRIBED)
    results = aerocues.run(
        dataset,
        chosen,
        work / f"{dataset.name}-results",
        detectors=DETECTORS,
        timing="estimated",
        max_keypoints=KEYPOINTS,
    )
    return results.table().with_columns(pl.col(INLIERS).fill_null(0.0))


def seconds(dataset: Dataset, pair: Pair) -> tuple[float, float]:
    """CPU seconds to build the reference of a pair, and to compare 1,000 matches with it."""
    first, second = (read_inner(dataset.image(name)) for name in (pair.image_1, pair.image_2))
    builder = ReferenceBuilder()
    began = time.process_time()
    reference = builder.build(builder.prepare(first), builder.prepare(second))
    built = time.process_time() - began
    correspondence = reference.correspondence(first, second)
    if correspondence is None:
        return built, math.nan
    size = (first.bgr.shape[1] - 1, first.bgr.shape[0] - 1)
    points = (np.random.default_rng(0).random((1000, 2)) * size).astype(np.float32)
    began = time.process_time()
    for _ in range(REPEATS):
        coverage(points[correspondence.errors(points, points) <= 3], first.bgr.shape)
    return built, (time.process_time() - began) / REPEATS


def number(image: str) -> int:
    """The number in the name of an image's file."""
    return int("".join(filter(str.isdigit, Path(image).stem)))


def line(rows: pl.DataFrame, dataset: Dataset, pair: Pair) -> dict[str, object]:
    """What is said of a pair."""
    own = rows.filter((pl.col("pair") == pair.index) & pl.col(TRUTH).is_not_null())
    built, compared = seconds(dataset, pair)
    told = own.row(0, named=True)
    said: dict[str, object] = {
        "pair": f"{pair.sequence} {number(pair.image_1)}-{number(pair.image_2)}",
        "agreement": told["reference_agreement"],
        "combinations": len(own),
        "CPU s": built,
        "ms": 1000 * compared,
    }
    if told["reference"] != FLOW:
        return {**said, "Spearman": None, "error": None, "repeatability": None, "inliers": None}
    known = own.filter(pl.col("ref_repeatability").is_not_null())
    return {
        **said,
        "Spearman": spearmanr(own[TRUTH], own[REFERENCE]).statistic,
        "error": (own[TRUTH] - own[REFERENCE]).abs().mean(),
        "repeatability": spearmanr(known["gt_repeatability"], known["ref_repeatability"]).statistic,
        "inliers": spearmanr(own[TRUTH], own[INLIERS]).statistic,
    }


def main() -> None:
    """Measure and print."""
    work = Path(sys.argv[1])
    work.mkdir(parents=True, exist_ok=True)
    cv2.setNumThreads(1)
    lines = []
    for dataset in datasets(work):
        rows = measured(dataset, work)
        lines += [line(rows, dataset, pair) for pair in dataset.pairs]
    table = pl.DataFrame(lines)
    with pl.Config(tbl_rows=-1, tbl_cols=-1, tbl_formatting="MARKDOWN", float_precision=3):
        print(table)
        for figure in ("Spearman", "inliers", "repeatability"):
            print(figure, "median", table[figure].median(), "worst", table[figure].min())


if __name__ == "__main__":
    main()
