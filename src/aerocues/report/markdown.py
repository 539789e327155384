"""A short summary of results for a pull request or a chat, with the answer first."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from aerocues.report.comparison import comparison_of
from aerocues.report.entry import ReportEntry
from aerocues.report.model_figures import ordered_models
from aerocues.report.scores import GOOD, best_binary, cautions, fastest_good
from aerocues.results.typesetting import as_markdown

if TYPE_CHECKING:
    import polars as pl

    from aerocues.scoring.comparison import Comparison

TOP = 10
RATIOS = {
    "ref_precision@3": "share right",
    "precision_beyond_chance": "inlier ratio",
    "precision": "inlier ratio",
}
NAMED = 5
SPECIAL = re.compile(r"([\\`*_\[\]<>|#&~])")


def summary(entries: Sequence[ReportEntry], title: str) -> str:
    """The best combinations of each dataset, their uncertainty, and the settings.

    Parameters
    ----------
    entries : sequence of ReportEntry
    title : str
    """
    lines = [f"# {_escaped(title)}", ""]
    for found in entries:
        lines += [*_entry(found, heading=len(entries) > 1), ""]
    comparison = comparison_of([found.entry for found in entries])
    if comparison:
        lines += _across(comparison)
    return "\n".join(lines).rstrip() + "\n"


def _escaped(text: str) -> str:
    return SPECIAL.sub(r"\\\1", " ".join(text.split()))


def _entry(found: ReportEntry, *, heading: bool) -> Iterator[str]:
    if heading:
        yield f"## {_escaped(found.name)}"
        yield ""
    yield _answer(found)
    yield ""
    yield from _others(found)
    yield ""
    yield as_markdown(_table(found)).rstrip()
    yield ""
    if not found.models.is_empty():
        yield from _models(found)
        yield ""
    yield _how(found)


def _answer(found: ReportEntry) -> str:
    ranking = found.ranking
    best = ranking.frame("combination").row(0, named=True)
    table = ranking.scores.table
    sure = ""
    if best["score_low"] is not None and ranking.resampled.units > 1:
        sure = (
            f" (95 % interval {best['score_low']:.3f} to {best['score_high']:.3f}), first in "
            f"{100 * best['probability_best']:.0f} % of the resamples"
        )
    return (
        f"**`{best['combination']}`** is the best of {len(ranking.scores.order):,} combinations on "
        f"{len(table.repeats):,} image pairs of {_escaped(found.entry.dataset)}: "
        f"CUES {best['score']:.3f}{sure}, success on "
        f"{100 * best['success_rate']:.0f} % of the pairs."
    )


def _others(found: ReportEntry) -> Iterator[str]:
    ranking, names = found.ranking, found.combinations
    alike, untested = ranking.indistinguishable(), ranking.untested()
    if alike:
        yield f"- not significantly different on these pairs: {_listed(alike)}"
    if untested:
        yield f"- too few pairs for a test against: {_listed(untested)}"
    if len(ranking.scores.order) > 1 and not alike and not untested:
        yield "- significantly better than all others (corrected p < 0.05)"
    seconds = found.seconds()
    fast, binary = fastest_good(ranking, seconds), best_binary(ranking)
    if fast is not None:
        yield (
            f"- fastest with {100 * GOOD:.0f} % of its score: `{names[fast]}`, "
            f"{seconds[names[fast]]:.3f} s per image and pair"
        )
    if binary is not None:
        yield f"- best binary descriptor: `{names[binary]}`"
    yield from (f"- {caution}" for caution in cautions(ranking))


def _models(found: ReportEntry) -> Iterator[str]:
    """The best models, and the number of failures by reason."""
    rows = ordered_models(found)
    good = [row for row in rows if row["status"] == "ok"]
    yield f"3D models: {len(good)} of {len(rows)} reconstructions succeeded."
    for row in good[:NAMED]:
        # Imported reconstructions may lack any of these.
        facts = []
        if row["registered_images"] is not None and row["images"] is not None:
            facts.append(f"{row['registered_images']} of {row['images']} images")
        if row["points_3d"] is not None:
            facts.append(f"{row['points_3d']:,} points")
        if row["reprojection_error"] is not None:
            facts.append(f"{row['reprojection_error']:.2f} px")
        if row["position_rmse"] is not None:
            facts.append(f"cameras {row['position_rmse']:.1f} m off")
        yield f"- `{row['name']}`: {', '.join(facts)}"
    failed = Counter(row["status"] for row in rows if row["status"] != "ok")
    if failed:
        told = ", ".join(f"{status.replace('_', ' ')} {n}" for status, n in failed.most_common())
        yield f"- failed: {told}"


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - NAMED:,} more" if len(names) > NAMED else ""
    return ", ".join(f"`{name}`" for name in names[:NAMED]) + more


def _table(found: ReportEntry) -> pl.DataFrame:
    import polars as pl

    seconds = found.seconds()
    frame = found.ranking.frame("combination").head(TOP)
    names = frame["combination"].to_list()
    ratio = next((name for name in RATIOS if name in frame.columns), None)
    return frame.select(
        "rank",
        pl.format("`{}`", "combination").alias("combination"),
        pl.col("score").alias("CUES"),
        pl.Series("95 %", [_span(*each, ".3f") for each in _ends(frame, "score")]),
        pl.Series("ranks", [_span(*each, ".0f") for each in _ends(frame, "rank")]),
        pl.Series("success", [f"{100 * each:.0f} %" for each in frame["success_rate"]]),
        *([pl.col(ratio).alias(RATIOS[ratio])] if ratio else []),
        pl.Series("seconds", [seconds.get(name) for name in names], dtype=pl.Float64),
    )


def _ends(frame: pl.DataFrame, name: str) -> list[tuple[float | None, float | None]]:
    return frame.select(f"{name}_low", f"{name}_high").rows()


def _span(low: float | None, high: float | None, form: str) -> str:
    return "" if low is None or high is None else f"{low:{form}} - {high:{form}}"


def _how(found: ReportEntry) -> str:
    settings = found.ranking.settings()
    whole = settings["resampled"] == "block"
    timing = ", ".join(str(kind) for kind in found.rows["timing"].unique().drop_nulls().sort())
    version = (found.settings.get("versions") or {}).get("opencv")
    facts = [
        f"{settings['resamples']:,} resamples of {'sequences' if whole else 'pairs'}",
        f"scoring preset {found.entry.preset}, alpha {settings['alpha']:g}",
        f"failed pairs: {settings['failures']}",
        f"measured on {_escaped(found.entry.machine)}",
        *([f"times {timing}"] if timing else []),
        *([f"OpenCV {version}"] if version else []),
    ]
    return f"<sub>{'; '.join(facts)}</sub>"


def _across(comparison: Comparison) -> Iterator[str]:
    import polars as pl

    yield "## Across all datasets"
    yield ""
    frame = comparison.versatility().head(NAMED)
    shown = frame.select(
        pl.format("`{}`", "alternative").alias("combination"),
        pl.col("mean").alias("mean CUES"),
        pl.col("min").alias("lowest CUES"),
        pl.col("mean_rank").alias("mean rank"),
        pl.col("worst_rank").cast(pl.Int64).alias("worst rank"),
    )
    yield as_markdown(shown).rstrip()
    yield ""
    yield "Spearman's rank correlation between the rankings:"
    yield ""
    names = [_escaped(name) for name in comparison.names]
    columns = dict(zip(names, comparison.spearman(), strict=True))
    yield as_markdown(pl.DataFrame({"": names, **columns}, nan_to_null=True)).rstrip()
