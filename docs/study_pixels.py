"""Whether an answer found in small images holds in large ones, as Markdown; see docs/study.py."""

from __future__ import annotations

import polars as pl

import aerocues
from aerocues.results.combination_columns import combination_name
from docs.study_queries import markdown, rank_correlation

WIDTHS = ("1,000", "4,000")
SIZES = tuple(f"{width} px" for width in WIDTHS)
MODEL_FIGURES = {
    "registered_images": ("images", ",.0f"),
    "points_3d": ("points", ",.0f"),
    "reprojection_error": ("error, px", ".2f"),
    "position_rmse": ("camera error, m", ".3f"),
    "reconstruction_seconds": ("CPU s", ".0f"),
}


def widths_compared(small: aerocues.Results, large: aerocues.Results) -> str:
    """What the same flight says at both widths: ranks, cost, and models where both have some."""
    ranked = [aerocues.score(each, resamples=2).frame("combination") for each in (small, large)]
    bests = [frame["combination"][0] for frame in ranked]
    places = dict(ranked[1].select("combination", "rank").iter_rows())
    told = (
        f"Ranks at {SIZES[0]} and {SIZES[1]} have a correlation of {rank_correlation(*ranked)} "
        f"({len(ranked[0])} combinations). The best at {SIZES[0]} is `{bests[0]}`, which has place "
        f"{places.get(bests[0], 'none')} at {SIZES[1]}; there `{bests[1]}` is the best."
    )
    return "\n\n".join((told, _ranks(ranked, (small, large)), *_models(small, large)))


def _ranks(ranked: list[pl.DataFrame], both: tuple[aerocues.Results, aerocues.Results]) -> str:
    """A row a combination: places, share of right matches, CPU seconds a pair."""
    own = [frame.select("combination", "rank") for frame in ranked]
    figures = [
        each.table()
        .group_by(combination_name())
        .agg(
            pl.col("ref_precision@3").fill_null(0).mean().alias("right"),
            pl.col("total_seconds").median().alias("seconds"),
        )
        for each in both
    ]
    joined = own[0].join(own[1], on="combination", suffix="_large")
    for number, frame in enumerate(figures):
        joined = joined.join(frame, on="combination", suffix="_large" if number else "")
    labels = ("place", "right share", "CPU s a pair")
    lines = [("combination", *(f"{label} at {size}" for label in labels for size in SIZES))]
    for row in joined.sort("rank_large").iter_rows(named=True):
        names = ("right", "right_large", "seconds", "seconds_large")
        ranks = (str(row["rank"]), str(row["rank_large"]))
        figures_told = (_told(row[name], ".2f") for name in names)
        lines.append((f"`{row['combination']}`", *ranks, *figures_told))
    return markdown(lines)


def _models(small: aerocues.Results, large: aerocues.Results) -> tuple[str, ...]:
    """A row a combination that was reconstructed at both widths."""
    frames = [each.reconstructions() for each in (small, large)]
    if any(frame.is_empty() for frame in frames):
        return ()
    frames = [
        frame.filter(status="ok").select(combination_name(), *MODEL_FIGURES) for frame in frames
    ]
    joined = frames[0].join(frames[1], on="combination", suffix="_large")
    heads = [f"{label} at {size}" for label, _ in MODEL_FIGURES.values() for size in SIZES]
    lines = [("model", *heads)]
    for row in joined.sort("points_3d_large", descending=True).iter_rows(named=True):
        figures = [
            _told(row[column + end], style)
            for column, (_, style) in MODEL_FIGURES.items()
            for end in ("", "_large")
        ]
        lines.append((f"`{row['combination']}`", *figures))
    return (markdown(lines),)


def _told(value: float | None, style: str) -> str:
    return "" if value is None else f"{value:{style}}"
