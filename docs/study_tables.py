"""What the study's rows say about methods and measuring, as Markdown; see docs/study.py."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import polars as pl

import aerocues
from aerocues.errors import ScoreError
from aerocues.results.model_quality import MODEL_QUALITY
from aerocues.results.study_dictionary import dictionary
from aerocues.scoring.pair_figures import LINK_COVERAGE, LINK_QUALITY
from aerocues.scoring.settings import Failures
from docs.study_parts import MOST_NAMED, NOT_YET, Parts
from docs.study_pixels import widths_compared
from docs.study_queries import described, in_common, markdown, rank_correlation

PREDICTED = {MODEL_QUALITY: "quality", "registered_images": "images", "points_3d": "points"}
"""Figures of models, and what the page calls them."""
COMPARED = {
    LINK_QUALITY: "links x expected quality, by which the objective `reconstruction` chooses,",
    LINK_COVERAGE: "links x coverage",
    "success_rate": "successful pairs",
    "ref_matches@3": "right matches",
    "inliers": "inliers",
}
"""Figures of pairs whose correlation with the quality of models is told for each part."""
TARGET = 2_000
REACHED = 0.95
"""Keypoints of an image that the parts with `tuned` ask for, and the share that counts as found."""
ENOUGH_MODELS = 8
"""Of fewer models, many figures have a high correlation by chance."""


def _best_of(values: Mapping[tuple[str, str], float], outcome: str) -> str:
    """The figures of pairs that correlate most with a figure of models."""
    own = {feature: value for (feature, which), value in values.items() if which == outcome}
    order = sorted(own, key=lambda name: -abs(own[name]))[:MOST_NAMED]
    return ", ".join(f"`{name}` {own[name]:.2f}" for name in order)


def _by_pairs(
    found: aerocues.Results, preset: str, failures: Failures | None = None
) -> pl.DataFrame:
    """The ranking by pairs alone: models were built in few parts, and there not with all."""
    ranking = aerocues.score(found, preset, failures=failures, reconstruction=False, resamples=2)
    return ranking.frame("combination")


@dataclass(frozen=True)
class Tables(Parts):
    """Statements about criteria, presets and sets of methods, and the data card."""

    def criteria(self) -> str:
        """What the choice of criteria and counting failures change in the rankings."""
        ways = {"inliers": "inliers", "thesis": "thesis", "failures left out": None}
        heads = ("part", "best: default", *(f"best: {way}" for way in ways))
        lines: list[tuple[str, ...]] = [(*heads, *(f"agreement: {way}" for way in ways))]
        for name in (name for name in self.names if name.endswith("-tuned")):
            [found] = self.results([name])
            usual = _by_pairs(found, "default")
            frames = [
                _by_pairs(found, preset) if preset else _by_pairs(found, "default", failures="omit")
                for preset in ways.values()
            ]
            bests = [f"`{frame['combination'][0]}`" for frame in (usual, *frames)]
            agreement = [rank_correlation(usual, frame) for frame in frames]
            lines.append((f"`{name}`", *bests, *agreement))
        return markdown(lines) if lines[1:] else NOT_YET

    def failures(self) -> str:
        """How the rows ended."""
        if self.study is None:
            return NOT_YET
        rows = self.study.table()
        counts = rows.group_by("status").len().sort("len", "status", descending=[True, False])
        lines = [("status", "rows", "share", "most often with the detector")]
        for status, number in counts.iter_rows():
            if status != "ok":
                most = rows.filter(pl.col("status") == status)["detector"].mode().sort()[0]
                lines.append((f"`{status}`", f"{number:,}", f"{number / len(rows):.1%}", most))
        return markdown(lines) if lines[1:] else "No row failed."

    def predictors(self) -> str:
        """Which figures of pairs predict what models are like."""
        lines = [("part", "models", *(f"predicts {told} best" for told in PREDICTED.values()))]
        quality: dict[str, list[str]] = {name: [] for name in COMPARED}
        for name, related in self._related().items():
            values = {
                (row["feature"], row["outcome"]): row["spearman"]
                for row in related.frame().drop_nulls().iter_rows(named=True)
            }
            best = [_best_of(values, outcome) for outcome in PREDICTED]
            lines.append((f"`{name}`", str(len(related.combinations)), *best))
            for figure, known in quality.items():
                value = values.get((figure, MODEL_QUALITY))
                known.append("?" if value is None else f"{value:.2f}")
        told = "; ".join(f"{COMPARED[name]} {', '.join(known)}" for name, known in quality.items())
        summary = f"Correlations with the quality of the models of these parts: {told}.\n\n"
        return summary + markdown(lines) if lines[1:] else NOT_YET

    def _related(self) -> dict[str, aerocues.Relations]:
        """The relations of the parts that have enough models."""
        found = {}
        for name in self.names:
            [results] = self.results([name])
            if results.reconstructions().is_empty():
                continue
            try:
                related = aerocues.relate_outcomes(results)
            except ScoreError:  # too few models, or nothing varies
                continue
            if len(related.combinations) >= ENOUGH_MODELS:
                found[name] = related
        return found

    def presets(self) -> str:
        """What `tuned` gains over the parameters of the thesis."""
        right, share = "right matches a pair", "their share of all"
        heads = (f"{right}: thesis", "tuned", f"{share}: thesis", "tuned")
        lines: list[tuple[str, ...]] = [("images", "combinations", *heads)]
        for images in ("synthetic", "oxford"):
            names = [f"{images}-thesis", f"{images}-tuned"]
            if set(names) <= set(self.names):
                thesis, tuned = (each.table() for each in self.results(names))
                if found := in_common(thesis, tuned):
                    lines.append((images, *found))
        return markdown(lines) if lines[1:] else NOT_YET

    def reached(self) -> str:
        """Which detectors find fewer keypoints than they may, by part."""
        if self.study is None:
            return NOT_YET
        with_keypoints = pl.col("part").is_in(self.names) & (pl.col("max_keypoints") == TARGET)
        found = (
            self.study.table()
            .filter(with_keypoints, pl.col("part").str.ends_with("-tuned"))
            .group_by("part", "detector", "descriptor")
            .agg(pl.concat_list("keypoints_1", "keypoints_2").explode().median().alias("found"))
            .group_by("part", "detector")
            .agg(pl.col("found").max())
            .filter(pl.col("found") < REACHED * TARGET)
            .sort("part", "detector")
        )
        told = [
            f"{detector} on {', '.join(f'`{part}`' for part in own['part'])}"
            for (detector,), own in found.group_by("detector", maintain_order=True)
        ]
        limit = f"fewer than {REACHED:.0%} of {TARGET:,} keypoints in the median image"
        return f"- Detectors that find {limit}: {'; '.join(sorted(told)) or 'none'}."

    def learned(self) -> str:
        """The best of the learned set beside SIFT, by part."""
        return self._ranked([name for name in self.names if name.endswith("-learned")])

    def extra(self) -> str:
        """The best of the extra set."""
        return self._ranked([name for name in self.names if name.endswith("-extra")])

    def _ranked(self, names: Sequence[str]) -> str:
        lines = [("part", "combination", "CUES (95 %)", "ranks (95 %)")]
        for name in names:
            [found] = self.results([name])
            for row in aerocues.score(found).frame("combination").head(5).iter_rows(named=True):
                score = f"{row['score']:.2f} ({row['score_low']:.2f} to {row['score_high']:.2f})"
                ranks = f"{row['rank_low']} to {row['rank_high']}"
                lines.append((f"`{name}`", f"`{row['combination']}`", score, ranks))
        return markdown(lines) if lines[1:] else NOT_YET

    def pixels(self) -> str:
        """Whether the answer at 1,000 pixels holds at 4,000."""
        found = self.results(["mini-1000", "mini-4000"])
        if len(found) < 2:
            return NOT_YET
        return widths_compared(*found)

    def parts(self) -> str:
        """The parts with machines, versions and licences."""
        if self.study is None:
            return NOT_YET
        texts = ("part", "what it is", "licence of the images", "preset")
        lines: list[tuple[str, ...]] = [
            (*texts, "combinations", "pairs", "rows", "models", "finished steps", "CPU h")
        ]
        for row in self.study.parts().iter_rows(named=True):
            named = [row[name] or "" for name in ("title", "licence", "preset")]
            counts = [f"{row[name]:,}" for name in ("combinations", "pairs", "rows", "models")]
            hours = f"{row['cpu_hours']:.2f}"
            lines.append((f"`{row['part']}`", *named, *counts, row["finished"], hours))
        return markdown(lines)

    def versions(self) -> str:
        """The machines and versions behind the rows."""
        if self.study is None:
            return NOT_YET
        parts = self.study.parts()
        columns = {"aerocues": "aerocues", "opencv": "OpenCV", "machine": "machine"}
        return "\n".join(
            f"- {label}: {', '.join(parts[name].drop_nulls().unique().sort())}"
            for name, label in columns.items()
        )

    def dictionary(self) -> str:
        """Every column of every table."""
        head = ("column", "type", "unit", "definition")
        tables = {name: markdown([head, *described(own)]) for name, own in dictionary().items()}
        return "\n\n".join(f"### {name}\n\n{table}" for name, table in tables.items())
