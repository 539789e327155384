"""Do recommendations lead to the best models? Their place among all, and their regret.

    python benchmarks/outcome.py WORK [FLIGHT...] [--objectives NAMES] [--budget SECONDS]
        [--width PIXELS] [--keypoints NUMBER]

Five flights: brighton_beach as published and as flown, garfield_rgb (AEROCUES_SHARED_DATA) and two
simulated surveys whose strips are turned against each other, one over fields. `COMBINATIONS` race
on each for 3 minutes, a model is built with every one of them, and with COLMAP's default; then the
choice of each objective is found among these models, without and with the final; of objectives that
are not raced, what they choose from the rows of the race. Beside it are the choices of means over
consecutive pairs by the preset `inliers`. Interrupted, it goes on. Takes about two hours of an idle
machine: the races count wall time.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from pathlib import Path
from typing import Any

import polars as pl

import aerocues
from aerocues.datasets.dataset import Dataset
from aerocues.modelling.final import MODELS, scene_of_final
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.protocol import ReconstructionProtocol
from aerocues.reconstruction.reconstruct import open_results, reconstruct_scene
from aerocues.results.combination_columns import name_in_row
from aerocues.results.model_quality import POSES, best_first
from aerocues.results.reconstruction_schema import BASELINE
from aerocues.scoring.cues import score
from aerocues.scoring.measured import table_of
from aerocues.scoring.objectives import OBJECTIVES
from aerocues.tuning.recommendation import Recommendation

FEATURES = {
    "L2": "SIFT-SIFT SIFT-DAISY AKAZE-SIFT ORB-SIFT BRISK-SIFT GFTT_H-DAISY GFTT_H-SIFT FAST-SIFT "
    "FAST-DAISY STAR-DAISY STAR-SIFT MSER-SIFT TBMR-SIFT",
    "HAM": "SIFT-BEBLID AKAZE-AKAZE AKAZE-BEBLID ORB-ORB ORB-BEBLID ORB-TEBLID BRISK-BRISK "
    "BRISK-BEBLID GFTT-BRIEF GFTT-BRISK FAST-BRIEF AGAST-BEBLID STAR-BRISK",
}
COMBINATIONS = [f"{each}-{norm}-EXACT" for norm, own in FEATURES.items() for each in own.split()]
BUDGET = 180.0
"""Wall seconds on an idle machine; give a busy one more."""
CONSECUTIVE = 8
"""Consecutive pairs on which the old rule takes its means."""
SIMULATED = {
    "turned": (
        "suburb",
        11,
        '{"north": 60, "east": 60, "altitude": 60, "front": 0.75, "side": 0.6}',
    ),
    "fields": (
        "fields",
        42,
        '{"north": 60, "east": 84, "altitude": 60, "front": 0.75, "side": 0.65}',
    ),
}
"""Scene, seed and mission of each simulated flight."""
FLIGHTS = ("brighton", "brighton_flown", "garfield", *SIMULATED)
ACCURACY, TRACKS, POINTS = 0.4, 0.2, 0.4
"""Weights of the value of a model."""


@dataclass(frozen=True)
class Size:
    """What all combinations are given."""

    width: int = 800
    keypoints: int = 2000

    def opened(self, spec: str, **options: Any) -> Dataset:
        """The images of a flight, shrunk."""
        return aerocues.open_dataset(spec, max_width=self.width, **options)


def flight(name: str, work: Path) -> str:
    """Where the images of a flight are; they are made where they are missing."""
    if name in SIMULATED:
        scene, seed, mission = SIMULATED[name]
        survey, folder = work / f"{name}.json", work / name
        survey.write_text(mission)
        words = ("simulate", "--survey", survey, "--scene", scene, "--seed", seed, "-o", folder)
        subprocess.run([sys.executable, "-m", "aerocues", *map(str, words)], check=True)
        return f"simulated:{folder}"
    flights = Path(os.environ.get("AEROCUES_SHARED_DATA", "../shared/data")) / "flights"
    if name == "garfield":
        return f"flight:{flights / 'garfield_rgb'}"
    if name == "brighton":
        return f"flight:{flights / 'brighton_beach'}"
    folder = work / "brighton_flown"
    for source in ("brighton_beach", "brighton_beach_as_flown"):
        shutil.copytree(flights / source, folder, dirs_exist_ok=True)
    return f"flight:{folder}"


def built(found: Recommendation, dataset: Dataset, keypoints: int) -> pl.DataFrame:
    """The models of all combinations under the settings of the final, the best first."""
    scene = scene_of_final(dataset, found.flight.survey if found.flight else None)
    options = ReconstructionOptions(
        preset=found.preset, protocol=ReconstructionProtocol(max_keypoints=keypoints)
    )
    models = reconstruct_scene(
        *(scene, COMBINATIONS, found.folder / MODELS, options),
        store=open_results(found.folder, scene),
    )
    wanted = {*COMBINATIONS, str(BASELINE)}
    table = models.table()
    names = [name_in_row(row) for row in table.iter_rows(named=True)]
    return best_first(table.filter(pl.Series([name in wanted for name in names])))


def values(models: pl.DataFrame) -> dict[str, float]:
    """Q of each model: placed share x (1 + g) / 2.

    g is .4 accuracy, .2 track length and .4 sqrt(points in 3 images or more), each relative to the
    best; accuracy is 1 / error of the surface, or of the cameras, where poses are known, else it
    has no weight.
    """
    rows = {name_in_row(row): row for row in models.iter_rows(named=True)}
    parts = {name: _parts(row) for name, row in rows.items()}
    best = [max(part[number] for part in parts.values()) for number in range(3)]
    weights = [
        weight if top else 0.0 for weight, top in zip((ACCURACY, TRACKS, POINTS), best, strict=True)
    ]
    found = {}
    for name, part in parts.items():
        shares = [
            weight * own / top if top else 0.0
            for weight, own, top in zip(weights, part, best, strict=True)
        ]
        found[name] = placed_share(rows[name]) * (1 + sum(shares) / sum(weights)) / 2
    return found


def _parts(row: Mapping[str, Any]) -> tuple[float, float, float]:
    error = (row["surface_error"] or row["position_rmse"]) if row["truth"] == POSES else None
    points = sqrt(row["points_in_3_images"] or 0)
    return (1 / error if error else 0.0, row["mean_track_length"] or 0.0, points)


def placed_share(row: Mapping[str, Any]) -> float:
    """Share of the images that are in their place."""
    placed = row["placed_images"]
    placed = row["registered_images"] if placed is None else placed
    return float((placed or 0) / row["images"])


@dataclass(frozen=True)
class Judge:
    """The models of a flight, the best first."""

    flight: str
    models: pl.DataFrame

    def told(self, rule: str, name: str) -> dict[str, object]:
        """The place of a choice among all models, its regret, and its figures beside COLMAP's."""
        rows = {name_in_row(row): row for row in self.models.iter_rows(named=True)}
        worth = values(self.models)
        own, plain = rows[name], rows[str(BASELINE)]
        return {
            "flight": self.flight,
            "rule": rule,
            "choice": "COLMAP" if name == str(BASELINE) else "-".join(name.split("-")[:2]),
            "place": list(rows).index(name) + 1,
            "of": len(rows),
            "regret": 1 - worth[name] / max(worth.values()),
            "images": f"{placed_share(own) * own['images']:.0f}/{own['images']}",
            "points": own["points_3d"],
            **{
                f"{what} / COLMAP": own[column] / plain[column] if plain[column] else None
                for what, column in (
                    ("points", "points_3d"),
                    ("error", "reprojection_error"),
                    ("CPU", "reconstruction_seconds"),
                )
                if own[column] is not None
            },
        }


def old_rule(spec: str, folder: Path, size: Size) -> str:
    """The best by means over consecutive pairs: CUES of the preset `inliers`."""
    dataset = size.opened(spec, pairs="consecutive", max_pairs=CONSECUTIVE)
    results = aerocues.run(
        dataset, COMBINATIONS, folder, timing="estimated", max_keypoints=size.keypoints
    )
    measured = table_of(results, "inliers", dataset=dataset.name, reconstruction=False)
    scores = score(measured.table, measured.preset.settings)
    return str(scores.table.alternatives[scores.order[0]])


def lines(
    name: str, work: Path, objectives: Sequence[str], budget: float, size: Size
) -> Iterator[dict[str, object]]:
    """A row for each objective, without and with the final, for COLMAP and for the old rule."""
    spec = flight(name, work)
    folder = work / f"{name}-race"
    dataset = size.opened(spec)
    judge = None
    for objective in objectives:
        found = aerocues.recommend(
            *(dataset, COMBINATIONS, folder),
            budget=budget,
            objective=objective,
            max_keypoints=size.keypoints,
        )
        judge = judge or Judge(name, built(found, dataset, size.keypoints))
        yield judge.told(f"{objective}, race", found.leader)
        yield judge.told(f"{objective}, final", found.best)
    assert judge is not None
    for objective in OBJECTIVES:
        if objective not in objectives:
            chosen = aerocues.choose([folder], objective)
            yield judge.told(f"{objective}, rows of the race", chosen.best)
    yield judge.told("COLMAP's default", str(BASELINE))
    yield judge.told("SIFT-SIFT", "SIFT-SIFT-L2-EXACT")
    yield judge.told("inliers, consecutive", old_rule(spec, work / f"{name}-consecutive", size))


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("work", type=Path)
    parser.add_argument("flights", nargs="*", default=FLIGHTS)
    parser.add_argument("--objectives", default=",".join(OBJECTIVES))
    parser.add_argument("--budget", type=float, default=BUDGET)
    parser.add_argument("--width", type=int, default=Size.width)
    parser.add_argument("--keypoints", type=int, default=Size.keypoints)
    asked = parser.parse_args()
    size = Size(asked.width, asked.keypoints)
    asked.work.mkdir(parents=True, exist_ok=True)
    found = []
    for name in asked.flights:
        found += list(lines(name, asked.work, asked.objectives.split(","), asked.budget, size))
        pl.DataFrame(found).write_csv(asked.work / "outcome.csv")
    table = pl.DataFrame(found)
    means = table.group_by("rule", maintain_order=True).agg(
        pl.col("regret").mean(), pl.col("regret").max().alias("worst"), pl.col("place").mean()
    )
    pl.Config.set_tbl_width_chars(250)
    pl.Config.set_fmt_str_lengths(60)
    with pl.Config(tbl_rows=-1, tbl_cols=-1, tbl_formatting="MARKDOWN", float_precision=3):
        print(table)
        print(means)


if __name__ == "__main__":
    main()
