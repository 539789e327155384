"""Scores of image pairs, compared with the models that combinations lead to.

    python benchmarks/model_scores.py WORK [RESULTS...]

Flies four simulated surveys, measures `COMBINATIONS` on their representative pairs and builds a
model with each, 800 pixels and 2,000 keypoints; then prints, for these and for other results with
models, such as parts of the study: Spearman's correlation of each score with the quality of the
models, and how much worse the model of its best is than the best one. A second table multiplies by
the time as `balanced` does.
Interrupted, it goes on. The surveys take about 20 minutes on one core.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import polars as pl
from numpy.typing import NDArray
from scipy.stats import spearmanr

import aerocues
from aerocues.results.combination_columns import COMBINATION, combination_name
from aerocues.results.model_quality import MODEL_QUALITY
from aerocues.scoring.combinations import decision_table
from aerocues.scoring.criteria import criteria_named
from aerocues.scoring.objectives import OBJECTIVES

Array = NDArray[np.float64]
FLIGHTS: Mapping[str, tuple[str, int, dict[str, object]]] = {
    "industrial": ("industrial", 3, {"north": 60, "east": 60, "altitude": 60, "side": 0.6}),
    "high": ("fields", 9, {"north": 120, "east": 120, "altitude": 100, "front": 0.7, "side": 0.6}),
    "oblique": ("suburb", 7, {"pitch": -65, "north": 70, "east": 60, "altitude": 60, "side": 0.65}),
    "double": (
        "suburb",
        101,
        {"pattern": "double", "north": 60, "east": 60, "altitude": 70, "front": 0.65, "side": 0.5},
    ),
}
"""Scene, seed and mission of each; images of a strip overlap by .75 where nothing else is said."""
FEATURES = {
    "L2": "SIFT-SIFT AKAZE-SIFT ORB-SIFT BRISK-SIFT GFTT_H-DAISY STAR-DAISY STAR-SIFT MSER-SIFT "
    "FAST-SIFT",
    "HAM": "SIFT-BEBLID AKAZE-AKAZE AKAZE-BEBLID ORB-ORB ORB-BEBLID BRISK-BRISK FAST-BRIEF "
    "AGAST-BEBLID STAR-BRISK KAZE-BRISK",
}
COMBINATIONS = [f"{each}-{norm}-EXACT" for norm, own in FEATURES.items() for each in own.split()]
CRITERIA = ("coverage", "ref_matches@3", "expected_quality", "total_seconds")


def flown(name: str, work: Path) -> Path:
    """Results of one survey, with its models."""
    scene, seed, mission = FLIGHTS[name]
    survey, images, folder = work / f"{name}.json", work / name, work / f"{name}-results"
    survey.write_text(json.dumps({"front": 0.75, **mission}))
    words = ("--survey", survey, "--scene", scene, "--seed", seed, "--size", "800x532")
    command = [sys.executable, "-m", "aerocues", "simulate", *map(str, words), "-o", str(images)]
    subprocess.run(command, check=True)
    spec = f"simulated:{images}"
    aerocues.run(spec, COMBINATIONS, folder, max_keypoints=2000, equal_footing=True)
    models = work / f"{name}-models"
    aerocues.reconstruct(spec, COMBINATIONS, models, results=folder, max_keypoints=2000)
    return folder


@dataclass(frozen=True)
class Figures:
    """Of the combinations with models: links, means of the criteria, and the models' quality."""

    links: Array
    means: Mapping[str, Array]
    quality: Array

    @property
    def hurry(self) -> Array:
        """What `balanced` multiplies by."""
        return OBJECTIVES["balanced"].hurry(self.means["total_seconds"])


SCORES: Mapping[str, Callable[[Figures], Array]] = {
    "coverage": lambda one: one.means["coverage"],
    "right matches": lambda one: one.means["ref_matches@3"],
    "links x coverage": lambda one: one.links * one.means["coverage"],
    "links x right matches": lambda one: one.links * one.means["ref_matches@3"],
    "links x expected quality": lambda one: one.links * one.means["expected_quality"],
}


def figures(folder: str) -> Figures:
    """The figures of results with models; a failed pair has a link and values of 0."""
    results = aerocues.Results(folder)
    criteria = criteria_named(CRITERIA)
    table = decision_table(results.table(), criteria, chance_fails=True, links=True)
    assert table.links is not None
    models = results.reconstructions().with_columns(combination_name())
    quality = dict(models.select(COMBINATION, pl.col(MODEL_QUALITY).fill_null(0.0)).iter_rows())
    places = [at for at, name in enumerate(table.alternatives) if name in quality]
    means = np.nan_to_num(table.values).sum(axis=1) / np.maximum(table.tried, 1)[:, None]
    return Figures(
        table.links.factor(np.ones((1, len(table.repeats))))[0][places],
        {name: means[places, at] for at, name in enumerate(CRITERIA)},
        np.array([quality[table.alternatives[at]] for at in places]),
    )


def compared(found: Mapping[str, Figures], *, hurried: bool) -> pl.DataFrame:
    """Correlation and regret of each score, by results and in the mean."""
    lines: list[dict[str, object]] = []
    for name, score in SCORES.items():
        values = [score(one) * (one.hurry if hurried else 1.0) for one in found.values()]
        both = list(zip(values, (one.quality for one in found.values()), strict=True))
        correlations = [float(spearmanr(own, quality).statistic) for own, quality in both]
        regrets = [float(1 - quality[own.argmax()] / quality.max()) for own, quality in both]
        cells = [f"{c:.2f} / {r:.2f}" for c, r in zip(correlations, regrets, strict=True)]
        mean = f"{np.mean(correlations):.2f} / {np.mean(regrets):.3f}"
        lines.append({"score": name, **dict(zip(found, cells, strict=True)), "mean": mean})
    return pl.DataFrame(lines)


def main() -> None:
    """Measure and print."""
    work, *others = sys.argv[1:]
    Path(work).mkdir(parents=True, exist_ok=True)
    folders = {name: str(flown(name, Path(work))) for name in FLIGHTS}
    folders |= {Path(folder.partition(":")[2] or folder).name: folder for folder in others}
    found = {name: figures(folder) for name, folder in folders.items()}
    with pl.Config(tbl_rows=-1, tbl_cols=-1, tbl_formatting="MARKDOWN", tbl_width_chars=250):
        print(compared(found, hurried=False))
        print(compared(found, hurried=True))


if __name__ == "__main__":
    main()
