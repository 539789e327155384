"""Learned and classic methods on the same pairs and in models: the tables of `docs/learned.md`.

    python arena.py measure DATASET NAME [--folder DIR] [--most N] [--lightglue]
    python arena.py models DATASET NAME [--folder DIR] [--upright] [--combinations A,B]
    python arena.py tables [--folder DIR]

`measure` takes representative pairs of a flight (at most N, and what holds all images), the pairs
of other datasets as they are. `tables` prints what is there, whatever was finished, as Markdown:
right matches and their share, CPU seconds, and the rank by CUES among all combinations and among
the classic ones alone. Everything goes on where it was interrupted.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

import polars as pl

import aerocues
from aerocues.datasets.dataset import Dataset
from aerocues.pipeline.flight_pairs import survey_flight
from aerocues.reconstruction.models import SETTINGS
from aerocues.reconstruction.opening import open_scene
from aerocues.results.combination_columns import COMBINATION, combination_name
from aerocues.scoring.measured import MeasuredRows

LEARNED = (
    *("XFEAT-XFEAT-L2-EXACT", "ALIKED_T16-ALIKED_T16-L2-EXACT"),
    *("XFEAT-XFEAT-L2-LIGHTERGLUE", "ALIKED_N16ROT-ALIKED_N16ROT-L2-EXACT"),
)
DENSE = ("PIXELMAP", "ORB-NONE-NONE-PIXELMAP")
EXTRA = ("SIFT-ROOTSIFT-L2-EXACT", "SIFT_COLMAP-SIFT-L2-EXACT")
# Its weights are not part of the package: it takes part where it is named.
LIGHTGLUE = "ALIKED_N16ROT-ALIKED_N16ROT-L2-LIGHTGLUE"
CLASSIC = (
    *("ORB-BEBLID-HAM-EXACT", "ORB-TEBLID-HAM-EXACT", "SIFT-SIFT-L2-EXACT", "STAR-DAISY-L2-EXACT"),
    *("GFTT_H-DAISY-L2-EXACT", "STAR-SIFT-L2-EXACT", "AKAZE-AKAZE-HAM-EXACT"),
    *("AKAZE-SIFT-L2-EXACT", "BRISK-BRISK-HAM-EXACT", "STAR-BRISK-HAM-EXACT"),
)
ALL = (*CLASSIC, *EXTRA, *LEARNED, *DENSE)
TURNED = 60.0
"""Degrees from which on two images are turned against each other."""
PRESET, KEYPOINTS, WIDTH = "tuned", 2000, 1000
SECONDS = ("detect_seconds_1", "detect_seconds_2", "describe_seconds_1", "describe_seconds_2")


def measured(dataset: str, folder: Path, most: int) -> Dataset:
    """The dataset with its representative pairs, which are written beside the results."""
    opened = aerocues.open_dataset(dataset, max_width=WIDTH)
    file = folder / "pairs.txt"
    if not file.exists():
        flight = survey_flight(opened, most, 0, lambda done, total: None, folder / "surveys")
        if flight is None:
            return opened
        lines = [f'"{pair.image_1}" "{pair.image_2}"\n' for pair in flight.dataset.pairs]
        file.write_text("".join(lines), encoding="utf-8")
    return aerocues.open_dataset(dataset, max_width=WIDTH, pairs=str(file))


def measure(dataset: str, folder: Path, most: int, combinations: Sequence[str]) -> None:
    """Measure combinations one after the other, so that each is there as soon as possible."""
    folder.mkdir(parents=True, exist_ok=True)
    aerocues.run(
        measured(dataset, folder, most),
        combinations,
        folder / "results",
        preset=PRESET,
        max_keypoints=KEYPOINTS,
        equal_footing=False,
        timing="estimated",
        workers=1,
        features=folder / "features",
    )


def models(dataset: str, folder: Path, combinations: Sequence[str], *, upright: bool) -> None:
    """Make models of a flight, of the features that were measured where they are there."""
    opened = open_scene(dataset, max_width=WIDTH)
    aerocues.reconstruct(
        aerocues.upright(opened, folder=folder / "surveys") if upright else opened,
        combinations,
        folder / ("models-upright" if upright else "models"),
        preset=PRESET,
        max_keypoints=KEYPOINTS,
        equal_footing=False,
        baseline=not upright,
        workers=1,
        features=folder / "features",
        retry_failed=True,
    )


def ranks(results: aerocues.Results, rows: pl.DataFrame) -> dict[str, int]:
    """Ranks of combinations by CUES, 1 the best, among some rows of results."""
    if rows[COMBINATION].n_unique() < 2:
        return {}
    measured_rows = MeasuredRows(rows.drop(COMBINATION), results.reconstructions())
    table = aerocues.score(measured_rows, reconstruction=False).frame()
    return dict(table.select(COMBINATION, "rank").iter_rows())


def pair_figures(folder: Path) -> dict[str, dict[str, float]]:
    """Figures of each combination of one measured data set, where all its pairs are measured."""
    results = aerocues.Results(folder)
    rows = results.table().with_columns(combination_name())
    known = "gt" if rows["gt_precision@3"].is_not_null().any() else "ref"
    share = pl.col(f"{known}_precision@3").fill_null(0.0)
    image = pl.sum_horizontal(f"{name}_cpu" for name in SECONDS) / 2
    right, turned = pl.col("right"), pl.col("reference_turn").fill_null(0.0) > TURNED
    figures = (
        rows.with_columns(right=share * pl.col("matches").fill_null(0), image=image)
        .group_by(COMBINATION)
        .agg(
            pl.len().alias("pairs"),
            right=right.filter(~turned).median().round(),
            turned=right.filter(turned).median().round(),
            share=share.median(),
            image=pl.col("image").median(),
            match=pl.col("match_seconds_cpu").median(),
        )
        .filter(pl.col("pairs") == rows["pair"].n_unique())
    )
    rows = rows.filter(pl.col(COMBINATION).is_in(figures[COMBINATION].implode()))
    ranked = ranks(results, rows)
    apart = ranks(results, rows.filter(pl.col(COMBINATION).is_in(CLASSIC)))
    return {
        row[COMBINATION]: {
            **row,
            "rank": ranked[row[COMBINATION]],
            "classic": apart.get(row[COMBINATION], 0),
        }
        for row in figures.iter_rows(named=True)
    }


def pair_lines(root: Path, names: Sequence[str]) -> Iterator[str]:
    """A column for each data set: right matches / of turned pairs (share), rank (of classic)."""
    found = {name: pair_figures(root / name / "results") for name in names}
    yield f"| combination | {' | '.join(names)} | s image | s pair |"
    yield f"|---|{'---|' * len(names)}---|---|"
    for combination in (*ALL, LIGHTGLUE):
        own = f"{combination}-NONE-NONE-{combination}" if "-" not in combination else combination
        cells, times = [], {}
        for name in names:
            if row := found[name].get(own):
                times = times or row
                classic = f" ({row['classic']:.0f})" if row["classic"] else ""
                right = [
                    f"{each:,.0f}" for each in (row["right"], row["turned"]) if each is not None
                ]
                cells.append(
                    f"{' / '.join(right)} ({row['share']:.2f}), {row['rank']:.0f}{classic}"
                )
            else:
                cells.append("")
        if times:
            spent = f"{times['image'] or 0:.2f} | {times['match']:.2f}"
            yield f"| `{combination}` | {' | '.join(cells)} | {spent} |"


def model_lines(folder: Path) -> Iterator[str]:
    """The table of the models of one flight."""
    heads = ("images", "points", "error (px)", "cameras off (m)", "track", "CPU s", "quality")
    yield f"| combination | {' | '.join(heads)} |"
    yield "|---|---|---|---|---|---|---|---|"
    table = aerocues.Models(folder).table().with_columns(combination_name())
    for row in table.sort("model_quality", descending=True, nulls_last=True).iter_rows(named=True):
        placed = row["placed_images"] if row["placed_images"] is not None else "?"
        shown = (
            f"{row['registered_images'] or 0} ({placed} in place) of {row['images']}",
            f"{row['points_3d'] or 0:,}",
            f"{row['reprojection_error'] or 0:.2f}",
            "" if row["position_rmse"] is None else f"{row['position_rmse']:.3f}",
            f"{row['mean_track_length'] or 0:.1f}",
            f"{row['reconstruction_seconds'] or 0:.0f}",
            f"{row['model_quality'] or 0:.0f}",
        )
        yield f"| `{row[COMBINATION]}` | {' | '.join(shown)} |"


def tables(root: Path) -> None:
    """Print what is there of all data sets."""
    folders = sorted(path for path in root.iterdir() if path.is_dir())
    names = [folder.name for folder in folders if (folder / "results").is_dir()]
    print(*pair_lines(root, names), sep="\n")
    for folder in folders:
        for name in ("models", "models-upright"):
            if (folder / name / SETTINGS).is_file():
                print(f"\n## {folder.name}: {name}\n", *model_lines(folder / name), sep="\n")


def main() -> None:
    """Read the arguments and do what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("measure", "models", "tables"))
    parser.add_argument("dataset", nargs="?")
    parser.add_argument("name", nargs="?")
    parser.add_argument("--folder", type=Path, default=Path("arena"))
    parser.add_argument("--most", type=int, default=8)
    parser.add_argument("--combinations", default=",".join(ALL))
    parser.add_argument("--upright", action="store_true")
    parser.add_argument("--lightglue", action="store_true", help="which needs its weights")
    asked = parser.parse_args()
    if asked.what == "tables":
        tables(asked.folder)
        return
    if asked.dataset is None or asked.name is None:
        parser.error(f"{asked.what} needs DATASET and NAME")
    folder = asked.folder / asked.name
    combinations = [*asked.combinations.split(","), *([LIGHTGLUE] if asked.lightglue else [])]
    if asked.what == "measure":
        measure(asked.dataset, folder, asked.most, combinations)
    else:
        models(asked.dataset, folder, combinations, upright=asked.upright)


if __name__ == "__main__":
    main()
