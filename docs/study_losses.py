"""Which detectors lose right matches where views change, as Markdown; see docs/study.py."""

from __future__ import annotations

from dataclasses import dataclass

import polars as pl

from aerocues.phrases import count
from docs.study_parts import NOT_YET, Parts
from docs.study_queries import QUERIES, console, markdown

RIGHT = pl.when(pl.col("status") == "ok").then(pl.col("ref_matches@3")).otherwise(0.0)
ENOUGH_DETECTORS = 10
"""Descriptors that fewer detectors go with say nothing about detectors."""
NOTHING = 0.005
TURNED_BY = 60.0


def kept_by(rows: pl.DataFrame, changed: pl.Expr) -> pl.DataFrame:
    """The share of right matches that each detector keeps, with each descriptor, least first.

    Parameters
    ----------
    rows : pl.DataFrame
        Rows of results; those where `changed` is null are left out, failed ones have 0.
    changed : pl.Expr
        Whether the view of a row is changed.
    """
    means = (
        rows.filter(pl.col("matcher") == "BF")
        .with_columns(changed.alias("changed"), RIGHT.fill_null(0.0).alias("right"))
        .drop_nulls("changed")
        .group_by("descriptor", "detector")
        .agg(
            pl.col("right").filter(~pl.col("changed")).mean().alias("before"),
            pl.col("right").filter("changed").mean().alias("after"),
        )
        .filter(pl.col("before") > 0)
    )
    return means.with_columns(kept=pl.col("after") / pl.col("before")).sort("descriptor", "kept")


def others_told(kept: pl.DataFrame) -> str:
    """Which detector loses most with each other descriptor, and with which several lose all."""
    told, all_lost = [], []
    for (descriptor,), own in kept.group_by("descriptor", maintain_order=True):
        if descriptor == "BRISK" or len(own) < ENOUGH_DETECTORS:
            continue
        if own["kept"][1] < NOTHING:
            all_lost.append(str(descriptor))
        else:
            told.append(f"{descriptor} {own['detector'][0]} ({own['kept'][0]:.0%})")
    ones = f" With other descriptors: {', '.join(told)}." if told else ""
    several = f" With {', '.join(all_lost)}, several detectors keep nothing." if all_lost else ""
    return ones + several


@dataclass(frozen=True)
class Losses(Parts):
    """Statements about what a change of the view costs each detector."""

    def suffers(self, query: str, before: str, after: str, changed: pl.Expr) -> str:
        """Which detector loses most of its right matches, and all others."""
        found = self.table(query)
        if not found.is_empty():
            kept = (pl.col(after) / pl.col(before)).alias("kept")
            found = found.drop_nulls().filter(pl.col(before) > 0).with_columns(kept).sort("kept")
        if found.is_empty():
            return f"{console(query)}\n\n{NOT_YET}"
        rows = self._rows(query).with_columns(changed.alias("changed")).drop_nulls("changed")
        numbers = [rows.filter(side)["pair"].n_unique() for side in (~pl.col("changed"), "changed")]
        least, most = found.row(0, named=True), found.row(-1, named=True)
        told = (
            f"{least['detector']} suffers most: it keeps {least['kept']:.0%} of its right matches "
            f"({least[before]:.0f} a pair become {least[after]:.0f}, on {numbers[0]} and "
            f"{count(numbers[1], 'pair')}); {most['detector']} keeps {most['kept']:.0%}."
            f"{others_told(kept_by(rows, pl.col('changed')))}"
        )
        lines = [("detector, with BRISK", before.replace("_", " "), after, "kept")]
        for row in found.iter_rows(named=True):
            figures = (f"{row[before]:.0f}", f"{row[after]:.0f}", f"{row['kept']:.0%}")
            lines.append((row["detector"], *figures))
        return f"{console(query)}\n\n{told}\n\n{markdown(lines)}"

    def _rows(self, query: str) -> pl.DataFrame:
        """The rows of the parts that a query is about."""
        assert self.study is not None
        return self.study.table().filter(pl.col("part").is_in(QUERIES[query][1]))

    def oblique(self) -> str:
        """Detectors on an oblique layer against a nadir one."""
        changed = pl.col("part").str.contains("oblique")
        return self.suffers("oblique", "nadir", "oblique", changed)

    def turned(self) -> str:
        """Detectors on turned pairs against others."""
        changed = pl.col("reference_turn") > TURNED_BY
        return self.suffers("turned", "same_heading", "turned", changed)
