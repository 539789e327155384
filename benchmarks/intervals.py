"""Do 95 % intervals of scores and ranks hold? The table of docs/agreement.md.

    python benchmarks/intervals.py WORK

A simulated survey of 56 images and its 200 or more pairs that overlap, 12 combinations. Sets of 6,
12 and 24 of these pairs are drawn again and again and scored as `aerocues score` does: how often
do the intervals of a set hold the score and the rank that all pairs give? Interrupted, measuring
goes on. Takes about ten minutes of one core.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import polars as pl
from numpy.typing import NDArray

import aerocues
from aerocues.scoring.bootstrap import bootstrap
from aerocues.scoring.cues import score
from aerocues.scoring.measured import MeasuredTable, table_of
from aerocues.scoring.settings import ScoreSettings
from aerocues.scoring.table import DecisionTable

MISSION = '{"north": 120, "east": 250, "altitude": 60, "front": 0.75, "side": 0.7}'
COMBINATIONS = (
    *("ORB-ORB-HAM-EXACT", "ORB-BEBLID-HAM-EXACT", "BRISK-BRISK-HAM-EXACT"),
    *("AKAZE-AKAZE-HAM-EXACT", "SIFT-SIFT-L2-EXACT", "GFTT_H-DAISY-L2-EXACT"),
    *("FAST-BRIEF-HAM-EXACT", "STAR-BRISK-HAM-EXACT", "AGAST-BEBLID-HAM-EXACT"),
    *("GFTT-BRISK-HAM-EXACT", "SIFT-BEBLID-HAM-EXACT", "ORB-SIFT-L2-EXACT"),
)
PRESETS = ("default", "models", "inliers")
SIZES, SETS, RESAMPLES = (6, 12, 24), 400, 400


def measured(work: Path) -> aerocues.Results:
    """All pairs of the survey, with all combinations."""
    survey, flight = work / "survey.json", work / "flight"
    survey.write_text(MISSION)
    words = ("simulate", "--survey", survey, "--seed", 77, "--size", "480x320", "-o", flight)
    subprocess.run([sys.executable, "-m", "aerocues", *map(str, words)], check=True)
    dataset = aerocues.open_dataset(f"simulated:{flight}", pairs="overlap:0.35-0.9")
    return aerocues.run(
        dataset, COMBINATIONS, work / "results", timing="estimated", max_keypoints=1000
    )


def part_of(table: DecisionTable, chosen: NDArray[np.intp]) -> DecisionTable:
    """The table with some of its repeats."""
    links = table.links
    if links is not None:
        links = replace(links, share=links.share[:, chosen], classes=links.classes[chosen])
    return replace(
        table,
        repeats=tuple(table.repeats[place] for place in chosen),
        blocks=table.blocks[chosen],
        values=table.values[:, chosen],
        failed=table.failed[:, chosen],
        links=links,
    )


def held(whole: MeasuredTable, size: int, generator: np.random.Generator) -> dict[str, float]:
    """How often the intervals of sets of pairs hold the score and the rank of all pairs."""
    table, settings = whole.table, whole.preset.settings
    truth = score(table, settings)
    found = [_one(table, settings, truth.scores, truth.ranks, size, generator) for _ in range(SETS)]
    score_in, rank_in, width, rank_width, shift = np.nanmean(np.array(found), axis=(0, 2))
    return {
        "score held": score_in,
        "rank held": rank_in,
        "width of score": width,
        "width of rank": rank_width,
        "score - whole": shift,
    }


def _one(
    table: DecisionTable,
    settings: ScoreSettings,
    scores: NDArray[np.float64],
    ranks: NDArray[np.float64],
    size: int,
    generator: np.random.Generator,
) -> NDArray[np.float64]:
    """(5, alternatives): score held, rank held, widths of both intervals, error of the score."""
    chosen = np.sort(generator.choice(len(table.repeats), size, replace=False))
    own = score(part_of(table, chosen), settings)
    resampled = bootstrap(own, RESAMPLES, int(generator.integers(2**31)))
    low, high = resampled.score_interval()
    first, last = resampled.rank_interval()
    slack = 1e-9
    return np.array(
        [
            np.where(np.isnan(low), np.nan, (low - slack <= scores) & (scores <= high + slack)),
            np.where(np.isnan(first), np.nan, (first <= ranks) & (ranks <= last)),
            high - low,
            last - first,
            own.scores - scores,
        ]
    )


def main() -> None:
    """Measure and print."""
    work = Path(sys.argv[1])
    work.mkdir(parents=True, exist_ok=True)
    results = measured(work)
    lines = []
    for preset in PRESETS:
        whole = table_of(results, preset)
        for size in SIZES:
            generator = np.random.default_rng(size)
            figures = held(whole, size, generator)
            of = len(whole.table.repeats)
            lines.append({"preset": preset, "pairs": size, "of": of, **figures})
            print(lines[-1], flush=True)
    with pl.Config(tbl_rows=-1, tbl_cols=-1, tbl_formatting="MARKDOWN", float_precision=3):
        print(pl.DataFrame(lines))


if __name__ == "__main__":
    main()
