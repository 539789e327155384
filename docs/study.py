"""Write what the study found: docs/study.md, the card of its data, and a sentence of the README.

``python -m docs.study`` rewrites what stands between ``<!-- NAME -->`` marks; the tests fail where
it is out of date. A statement is made only where the database holds its rows.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import polars as pl

import aerocues
from aerocues.errors import AerocuesError
from aerocues.phrases import count, likelihood
from aerocues.results.study_dictionary import dictionary
from aerocues.results.timing import DISTURBED
from docs.study_queries import QUERIES, console, described, in_common, markdown, rank_correlation

REPOSITORY = Path(__file__).resolve().parent.parent
DATABASE = REPOSITORY / "study" / "database"
NOT_YET = "*Not measured yet.*"
LIKELY = 0.05
MOST_NAMED = 4

CONDITIONS: tuple[tuple[str, tuple[str, ...], str], ...] = (
    ("nadir, all images with the same heading", ("suburb-nadir-tuned",), "reconstruction"),
    ("nadir, strips there and back (turned by 180°)", ("brighton-flown-tuned",), "reconstruction"),
    ("oblique", ("suburb-oblique-tuned", "fields-oblique-tuned"), "reconstruction"),
    ("oblique, there and back", ("suburb-natural-tuned", "fields-natural-tuned"), "reconstruction"),
    ("low texture (fields)", ("fields-nadir-tuned",), "reconstruction"),
    ("different kinds of image (Oxford)", ("oxford-tuned",), "accuracy"),
    ("neighbouring images of five projects", ("uav-tuned",), "reconstruction"),
    ("boards: all of these flights", ("brighton-flown-tuned", "suburb-nadir-tuned"), "speed"),
)
"""What a practitioner flies, the parts of the study that show it, and the objective."""


@dataclass(frozen=True)
class Findings:
    """What the database says, as Markdown."""

    place: Path = DATABASE

    @cached_property
    def study(self) -> aerocues.Study | None:
        """The database; None where nothing is in it."""
        try:
            return aerocues.Study(self.place)
        except AerocuesError:
            return None

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The parts of which a round is finished: fewer rows would favour what came first."""
        if self.study is None:
            return ()
        return tuple(self.study.parts().filter(pl.col("finished") != "")["part"])

    def results(self, names: Sequence[str]) -> list[aerocues.Results]:
        """The results of those of the parts that are there."""
        study = self.study
        return [study.part(name) for name in names if name in self.names] if study else []

    def table(self, query: str) -> pl.DataFrame:
        """The answer to a query; empty where the parts that it needs are missing."""
        text, needed = QUERIES[query]
        if self.study is None or not set(needed) <= set(self.names):
            return pl.DataFrame()
        return self.study.sql(text)

    def measured(self) -> str:
        """How much there is."""
        if self.study is None:
            return NOT_YET
        parts = self.study.parts()
        rows, models = int(parts["rows"].sum()), int(parts["models"].sum())
        failed = rows - int(parts["ok"].sum())
        most = parts.select(pl.max("combinations")).item()
        table = self.study.table()
        timed = table.filter(pl.col("timing") == "exclusive")
        shared = int((timed["wall_over_cpu"] > DISTURBED).sum())
        times = (
            f"{count(len(timed), 'row')} timed alone, {shared:,} of which had to share the core "
            "with other programs all the same; others are scaled by these."
            if len(timed)
            else "No row was timed alone yet: times are those of a busy machine."
        )
        return (
            f"So far: {count(rows, 'row')} in {count(len(parts), 'part')}, of which "
            f"{failed:,} failed or are not better than chance, and {count(models, 'model')}; up to "
            f"{most} of 340 combinations a part; {parts['cpu_hours'].sum():.2f} CPU hours. "
            f"{times} {count(int(parts['again'].sum()), 'row')} measured again: "
            f"{parts['identical'].sum():,} with identical quality."
        )

    def main_finding(self) -> str:
        """The first condition that was measured, in a sentence with intervals."""
        for title, names, _ in (CONDITIONS[1], *CONDITIONS):
            if found := self.results(names[:1]):
                frame = aerocues.score(found[0], "models").frame("combination")
                pairs = found[0].table()["pair"].n_unique()
                frame = frame.filter(pl.col("repeats") >= pairs / 2)
                best = frame.row(0, named=True)
                return (
                    f"**{title[0].upper()}{title[1:]}: {best['combination']}** is the best of "
                    f"{count(len(frame), 'combination')} on {count(pairs, 'pair')}: right matches "
                    f"cover {best['score']:.2f} of the image (95 % interval "
                    f"{best['score_low']:.2f} to {best['score_high']:.2f}), counting how surely "
                    "pairs are linked. The probability that it is the best is "
                    f"{likelihood(best['probability_best'])}."
                )
        return NOT_YET

    @cached_property
    def choices(self) -> dict[str, aerocues.Choice]:
        """The choice of each condition of which a part was measured."""
        found = {title: (self.results(names), aim) for title, names, aim in CONDITIONS}
        return {title: aerocues.choose(own, aim) for title, (own, aim) in found.items() if own}

    def advice(self) -> str:
        """What to take under each condition."""
        lines = [("you fly", "take", "sure", "may be as good", "measured")]
        for title, _, _ in CONDITIONS:
            if choice := self.choices.get(title):
                first = choice.ranked["probability"][0]
                others = choice.ranked[1:].filter(pl.col("probability") >= LIKELY)
                named = others.sort("probability", descending=True)["combination"].to_list()
                more = f" and {len(named) - MOST_NAMED} more" if named[MOST_NAMED:] else ""
                sure = "" if first is None else likelihood(first)
                good = ", ".join(f"`{each}`" for each in named[:MOST_NAMED]) + more
                on = f"{len(choice.ranked)} combinations, {choice.pairs} pairs"
                lines.append((title, f"`{choice.best}`", sure, good, on))
            else:
                lines.append((title, NOT_YET, "", "", ""))
        return markdown(lines)

    def changes(self) -> str:
        """How many conditions have a best of their own."""
        if len(self.choices) < 2:
            return NOT_YET
        bests = dict.fromkeys(choice.best for choice in self.choices.values())
        named = ", ".join(f"`{best}`" for best in bests)
        return (
            f"The {len(self.choices)} measured conditions have "
            f"{count(len(bests), 'different best', 'different bests')}: {named}."
        )

    def suffers(self, query: str, before: str, after: str) -> str:
        """Which detector loses most of its right matches, and all others."""
        found = self.table(query)
        if not found.is_empty():
            kept = (pl.col(after) / pl.col(before)).alias("kept")
            found = found.drop_nulls().filter(pl.col(before) > 0).with_columns(kept).sort("kept")
        if found.is_empty():
            return f"{console(query)}\n\n{NOT_YET}"
        least, most = found.row(0, named=True), found.row(-1, named=True)
        told = (
            f"{least['detector']} suffers most: it keeps {least['kept']:.0%} of its right matches "
            f"({least[before]:.0f} a pair become {least[after]:.0f}); {most['detector']} keeps "
            f"{most['kept']:.0%}."
        )
        lines = [("detector, with BRISK", before.replace("_", " "), after, "kept")]
        for row in found.iter_rows(named=True):
            figures = (f"{row[before]:.0f}", f"{row[after]:.0f}", f"{row['kept']:.0%}")
            lines.append((row["detector"], *figures))
        return f"{console(query)}\n\n{told}\n\n{markdown(lines)}"

    def oblique(self) -> str:
        """Detectors on an oblique layer against a nadir one."""
        return self.suffers("oblique", "nadir", "oblique")

    def turned(self) -> str:
        """Detectors on turned pairs against others."""
        return self.suffers("turned", "same_heading", "turned")

    def binary(self) -> str:
        """The best binary combinations under 50 ms."""
        found = self.table("binary")
        if found.is_empty():
            return f"{console('binary')}\n\n{NOT_YET}"
        lines: list[tuple[str, ...]] = [
            ("combination", "pairs", "coverage", "ms an image", "ms to match a pair")
        ]
        for row in found.iter_rows(named=True):
            name = f"`{row['detector']}-{row['descriptor']}-HAM-{row['matcher']}`"
            times = (f"{row[each] * 1e3:.0f}" for each in ("seconds", "to_match"))
            lines.append((name, str(row["pairs"]), f"{row['coverage']:.3f}", *times))
        return f"{console('binary')}\n\n{markdown(lines)}"

    def flann(self) -> str:
        """Brute force against FLANN at 8,000 keypoints."""
        found = self.table("flann")
        if found.is_empty():
            return f"{console('flann')}\n\n{NOT_YET}"
        lines = [("descriptors", "matcher", "pairs", "CPU s to match", "right matches a pair")]
        for row in found.iter_rows(named=True):
            kind = {"HAM": "strings of bits", "L2": "numbers"}[row["norm"]]
            figures = (f"{row['seconds']:.2f}", f"{row['right_matches']:.0f}")
            lines.append((kind, row["matcher"], str(row["pairs"]), *figures))
        return f"{console('flann')}\n\n{markdown(lines)}"

    def criteria(self) -> str:
        """What the choice of criteria and counting failures change in the rankings."""
        ways = {"inliers": "inliers", "thesis": "thesis", "failures left out": None}
        heads = ("part", "best: default", *(f"best: {way}" for way in ways))
        lines: list[tuple[str, ...]] = [(*heads, *(f"agreement: {way}" for way in ways))]
        for name in (name for name in self.names if name.endswith("-tuned")):
            [found] = self.results([name])
            usual = aerocues.score(found, "default", resamples=2).frame("combination")
            others = [
                aerocues.score(found, preset, resamples=2)
                if preset
                else aerocues.score(found, "default", failures="omit", resamples=2)
                for preset in ways.values()
            ]
            frames = [each.frame("combination") for each in others]
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
        """Which figures of pairs predict how many images a model holds."""
        lines = [("part", "models", "figures of pairs that predict registered images best")]
        for name in self.names:
            [found] = self.results([name])
            try:
                related = aerocues.relate_outcomes(found)
            except AerocuesError:
                continue
            if "registered_images" not in related.outcomes:
                continue
            own = related.spearman[:, related.outcomes.index("registered_images")]
            order = [place for place in np.argsort(-np.abs(own)) if np.isfinite(own[place])]
            told = ", ".join(f"`{related.features[p]}` {own[p]:.2f}" for p in order[:MOST_NAMED])
            lines.append((f"`{name}`", str(len(related.combinations)), told))
        return markdown(lines) if lines[1:] else NOT_YET

    def presets(self) -> str:
        """What `tuned` gains over the parameters of the thesis."""
        right, share = "right matches a pair", "their share of all"
        heads = (f"{right}: thesis", "tuned", f"{share}: thesis", "tuned")
        lines: list[tuple[str, ...]] = [("images", "combinations", *heads)]
        for images in ("synthetic", "oxford", "uav"):
            names = [f"{images}-thesis", f"{images}-tuned"]
            if set(names) <= set(self.names):
                thesis, tuned = (each.table() for each in self.results(names))
                lines.append((images, *in_common(thesis, tuned)))
        return markdown(lines) if lines[1:] else NOT_YET

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
        small, large = (aerocues.score(each, resamples=2).frame("combination") for each in found)
        times = [each.table().select(pl.median("total_seconds")).item() for each in found]
        agree = rank_correlation(small, large)
        return (
            f"Ranks at 1,000 and 4,000 pixels have a correlation of {agree} "
            f"({len(small)} combinations). The best is `{small['combination'][0]}` at 1,000 and "
            f"`{large['combination'][0]}` at 4,000; an image and a pair take {times[0]:.2f} s and "
            f"{times[1]:.2f} s in the median."
        )

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


PAGES: dict[str, tuple[str, ...]] = {
    "docs/study.md": (
        *(
            "measured",
            "advice",
            "main-finding",
            "changes",
            "binary",
            "flann",
            "oblique",
            "turned",
            "criteria",
            "failures",
        ),
        *("predictors", "presets", "learned", "extra", "pixels"),
    ),
    "study/README.md": ("parts", "versions", "dictionary"),
    "README.md": ("main-finding",),
}


def rendered(page: str, findings: Findings) -> str:
    """The text of a page with what the database says now."""
    text = (REPOSITORY / page).read_text(encoding="utf-8")
    for name in PAGES[page]:
        written: Callable[[], str] = getattr(findings, name.replace("-", "_"))
        between = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end of {name} -->)", re.DOTALL)
        place = between.search(text)
        if place is None:
            raise SystemExit(f"{page} has no place for {name}")
        text = f"{text[: place.start()]}{place[1]}{written()}\n{place[2]}{text[place.end() :]}"
    return text


if __name__ == "__main__":
    found = Findings()
    for page in PAGES:
        (REPOSITORY / page).write_text(rendered(page, found), encoding="utf-8")
