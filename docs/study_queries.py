"""Questions to the database of the study, and how answers are written; see docs/study.py."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import polars as pl
from scipy.stats import spearmanr

from aerocues.results.schema import Column

BINARY = """SELECT detector, descriptor, matcher, SUM(tried) AS pairs, MIN(covered) AS coverage,
MIN(share) AS ok, MAX(one) AS seconds, MAX(two) AS to_match FROM (
SELECT part, detector, descriptor, matcher, COUNT(*) AS tried,
AVG(CASE WHEN status = 'ok' THEN 1.0 ELSE 0.0 END) AS share,
AVG(CASE WHEN status = 'ok' THEN COALESCE(coverage, 0) ELSE 0 END) AS covered,
MEDIAN((detect_seconds_1 + detect_seconds_2 + describe_seconds_1 + describe_seconds_2) / 2) AS one,
MEDIAN(match_seconds) AS two FROM results WHERE norm = 'HAM' AND reference = 'flow'
AND part IN ('brighton-flown-tuned', 'suburb-nadir-tuned', 'suburb-oblique-tuned')
GROUP BY part, detector, descriptor, matcher) AS flights
GROUP BY detector, descriptor, matcher HAVING seconds < 0.05 AND COUNT(*) = 3
ORDER BY coverage DESC LIMIT 5"""
FLANN = """SELECT norm, matcher, COUNT(*) AS pairs, AVG(match_seconds) AS seconds,
AVG(total_seconds) AS in_all,
AVG(CASE WHEN status = 'ok' THEN COALESCE("ref_matches@3", 0) ELSE 0 END) AS right_matches
FROM results WHERE part = 'brighton-flann-8000' AND reference = 'flow'
GROUP BY norm, matcher ORDER BY norm, matcher"""
OBLIQUE = """SELECT detector,
AVG(CASE WHEN part = 'suburb-nadir-tuned' THEN found END) AS nadir,
AVG(CASE WHEN part = 'suburb-oblique-tuned' THEN found END) AS oblique FROM (
SELECT detector, part, CASE WHEN status = 'ok' THEN COALESCE("ref_matches@3", 0) ELSE 0 END
AS found FROM results WHERE descriptor = 'BRISK' AND matcher = 'BF') AS rows
GROUP BY detector ORDER BY detector"""
TURNED = """SELECT detector,
AVG(CASE WHEN reference_turn <= 60 THEN found END) AS same_heading,
AVG(CASE WHEN reference_turn > 60 THEN found END) AS turned FROM (
SELECT detector, reference_turn, CASE WHEN status = 'ok' THEN COALESCE("ref_matches@3", 0) ELSE 0
END AS found FROM results WHERE part = 'brighton-flown-tuned' AND descriptor = 'BRISK'
AND matcher = 'BF') AS rows GROUP BY detector ORDER BY detector"""
MODELS = """SELECT detector, descriptor, matcher, placed_images, points_in_3_images,
reprojection_error, reconstruction_seconds, model_quality FROM reconstructions
WHERE part = 'brighton-flown-tuned' AND model_quality > 0 ORDER BY model_quality DESC LIMIT 5"""
QUERIES: dict[str, tuple[str, tuple[str, ...]]] = {
    "binary": (BINARY, ("brighton-flown-tuned", "suburb-nadir-tuned", "suburb-oblique-tuned")),
    "flann": (FLANN, ("brighton-flann-8000",)),
    "oblique": (OBLIQUE, ("suburb-nadir-tuned", "suburb-oblique-tuned")),
    "turned": (TURNED, ("brighton-flown-tuned",)),
    "models": (MODELS, ("brighton-flown-tuned",)),
}
"""Questions to the database alone, and the parts that answer them."""


def console(query: str) -> str:
    """A query as a command."""
    text = QUERIES[query][0].replace('"', r"\"").replace("\n", " \\\n")
    return f'```console\n$ aerocues study --sql "{text}"\n```'


def described(columns: Sequence[Column]) -> Iterator[tuple[str, ...]]:
    """A row a column."""
    for each in columns:
        yield f"`{each.name}`", each.type, each.unit, each.definition


def rank_correlation(first: pl.DataFrame, second: pl.DataFrame) -> str:
    """Spearman's correlation of the scores of what two rankings have in common."""
    both = first.select("combination", "score").join(second, on="combination", suffix="_other")
    if len(both) < 3:
        return ""
    return f"{spearmanr(both['score'], both['score_other']).statistic:.2f}"


def in_common(thesis: pl.DataFrame, tuned: pl.DataFrame) -> tuple[str, ...]:
    """Means of two runs over the combinations and pairs that both measured, by the truth.

    The preset of the thesis knows no other right matches. A failed row has 0 where the
    truth of its pair is known. Empty where there is no truth.
    """
    keys = ["pair", "detector", "descriptor", "norm", "matcher"]
    share = pl.col("gt_precision@3")
    found = pl.when(pl.col("status") == "ok").then(share).otherwise(0.0)
    known = pl.concat(each.filter(share.is_not_null())["pair"] for each in (thesis, tuned))
    figures = (found * pl.col("matches")).alias("right"), found.alias("share")
    first, second = (
        each.filter(pl.col("pair").is_in(known.unique().implode()))
        .select(*keys, *figures)
        .fill_null(0.0)
        for each in (thesis, tuned)
    )
    both = first.join(second, on=keys)
    if both.is_empty():
        return ()
    means = both.select(pl.col("right", "right_right", "share", "share_right").mean()).row(0)
    number = both.select(keys[1:]).n_unique()
    return (str(number), *(f"{m:,.0f}" for m in means[:2]), *(f"{m:.2f}" for m in means[2:]))


def markdown(lines: Sequence[Sequence[str]]) -> str:
    """Rows as a Markdown table; the first one is the head."""
    head, *body = lines
    return "\n".join(f"| {' | '.join(line)} |" for line in (head, ["---"] * len(head), *body))
