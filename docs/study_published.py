"""What the published measurements of the thesis lost, as Markdown; see docs/study.py."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import polars as pl

from docs.study_parts import NOT_YET, Parts
from docs.study_queries import markdown
from study.measure import DATA

PUBLISHED = "published/measurements.parquet"
PART = "oxford-thesis"
PLACES = {"graf": 0, "bikes": 3, "bark": 4, "leuven": 6}
"""Place of each sequence among those published, which have no names: SIFT finds the same number of
matches, within 3 %, in each of its five pairs."""
PAIRS = 5
KEYS = ("detector", "descriptor", "norm", "matcher")
DROPPING = ("ORB", "BRISK", "FREAK", "BRIEF", "LATCH")
"""Descriptors that drop keypoints near the border."""


def published_pairs(file: Path) -> pl.DataFrame:
    """Inliers and matches as published, a row a pair of `PLACES`."""
    names = [pl.col(key).cast(pl.String).str.to_uppercase() for key in KEYS]
    places = {place: sequence for sequence, place in PLACES.items()}
    return (
        pl.read_parquet(file)
        .filter(pl.col("dataset") == "oxford", pl.col("platform") == "desktop")
        .select(*names, "inliers", "matches", place=pl.col("pair") // PAIRS, step="pair")
        .filter(pl.col("place").is_in(list(places)))
        .with_columns(
            pl.col("place").replace_strict(places, return_dtype=pl.String).alias("sequence"),
            pl.col("step") % PAIRS,
        )
    )


def both_measured(ours: pl.DataFrame, published: pl.DataFrame) -> pl.DataFrame:
    """The mean inlier ratio of each combination, published and here, on what both measured."""
    names = [pl.col(key).cast(pl.String) for key in KEYS]
    own = ours.select(*names, "sequence", "inliers", "matches", step=pl.col("pair") % PAIRS)
    joined = own.join(published, on=[*KEYS, "sequence", "step"], suffix="_published")
    ratios = [
        (pl.col(f"inliers{when}") / pl.col(f"matches{when}")).alias(f"ratio{when}")
        for when in ("", "_published")
    ]
    known = joined.select(*KEYS, *ratios).filter(
        *(pl.col(f"ratio{when}").is_finite() for when in ("", "_published"))
    )
    return known.group_by(KEYS).agg(pl.col("ratio", "ratio_published").mean())


def lost(ratios: pl.DataFrame, by: str) -> str:
    """Means of the inlier ratios by one method of a combination; what lost most comes first."""
    means = (
        ratios.group_by(by)
        .agg(pl.len().alias("number"), pl.col("ratio", "ratio_published").mean())
        .with_columns((pl.col("ratio") - pl.col("ratio_published")).alias("lost"))
        .sort("lost", by, descending=[True, False])
    )
    lines = [(by, "combinations", "inlier ratio, published", "measured here", "lost")]
    for row in means.iter_rows(named=True):
        figures = (f"{row[name]:z.2f}" for name in ("ratio_published", "ratio", "lost"))
        lines.append((row[by], str(row["number"]), *figures))
    return markdown(lines)


@dataclass(frozen=True)
class Published(Parts):
    """Statements about the published measurements, which are in no repository."""

    data: Path = DATA

    def stale_keypoints(self) -> str | None:
        """What looking matches up in old keypoints did; None where its figures are missing."""
        if PART not in self.names:
            return NOT_YET
        if not (self.data / PUBLISHED).is_file():
            return None
        [found] = self.results([PART])
        ratios = both_measured(found.table(), published_pairs(self.data / PUBLISHED))
        dropping = ratios.filter(pl.col("descriptor").is_in(DROPPING))
        others = ratios.filter(~pl.col("descriptor").is_in(DROPPING))
        change = float(np.median(np.abs(others["ratio"] - others["ratio_published"])))
        told = (
            f"{len(ratios)} combinations on {len(PLACES) * PAIRS} pairs of Oxford. Combinations "
            f"with another descriptor than {', '.join(DROPPING)} differ by {change:.3f} (median)."
        )
        detectors = "By detector, with these descriptors only:"
        tables = (lost(ratios, "descriptor"), detectors, lost(dropping, "detector"))
        return "\n\n".join((told, *tables))
