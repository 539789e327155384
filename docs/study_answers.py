"""What the study answers to a practitioner, as Markdown; see docs/study.py."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import polars as pl

import aerocues
from aerocues.phrases import count, likelihood
from docs.study_losses import Losses
from docs.study_models import Models
from docs.study_parts import MOST_NAMED, NOT_YET
from docs.study_queries import console, markdown
from study.outdated import outdated_rows
from study.plan import read_plan

CONDITIONS: tuple[tuple[str, str, str], ...] = (
    ("nadir, strips there and back (turned by 180°)", "brighton-flown-tuned", "reconstruction"),
    ("oblique", "suburb-oblique-tuned", "reconstruction"),
    ("nadir, all images with the same heading", "suburb-nadir-tuned", "reconstruction"),
    ("oblique, there and back", "suburb-natural-tuned", "reconstruction"),
    ("low texture (fields), nadir", "fields-nadir-tuned", "reconstruction"),
    ("low texture (fields), oblique", "fields-oblique-tuned", "reconstruction"),
    ("low texture, oblique, there and back", "fields-natural-tuned", "reconstruction"),
    ("different kinds of image (Oxford)", "oxford-tuned", "accuracy"),
    ("where time counts: the first of these flights, by speed", "brighton-flown-tuned", "speed"),
    ("neighbouring images of five projects", "uav-tuned", "reconstruction"),
)
"""What a practitioner flies, the part of the study that shows it, and the objective.

Choices and tests are by the pairs alone, as models were not built with all combinations.
The most telling comes first, as in study.toml: the README tells of the first that is measured.
"""


KINDS = {"HAM": "strings of bits", "L2": "numbers"}
"""Descriptors by the norm under which they are compared."""


def _mixed(table: pl.DataFrame) -> str:
    """How many parts have times of several kinds of machine."""
    kinds = table.group_by("part").agg(pl.col("machine").n_unique())
    number = kinds.filter(pl.col("machine") > 1).height
    told = "with times of several kinds of machine, which do not compare"
    return f" {count(number, 'part')} {told}." if number else ""


TESTED = "reconstruction"
"""The objective whose criteria a preset scores by, so that its test is about the choice."""


def _verdict(kind: str, brute: Mapping[str, float], flann: Mapping[str, float]) -> str:
    """Whether FLANN pays: more right matches in a second of one image and one pair."""
    to_match, right, in_all = (
        flann[name] / brute[name] for name in ("seconds", "right_matches", "in_all")
    )
    verdict = "it pays" if right > in_all else "it does not pay"
    return (
        f"For {kind}, FLANN takes {to_match:.2f} of the time of brute force to match and finds "
        f"{right:.0%} of its right matches, in {in_all:.2f} of the time of one image and "
        f"one pair: {verdict}."
    )


@dataclass(frozen=True)
class Finding:
    """What a part says about a condition: the choice, and the test that `score` makes."""

    choice: aerocues.Choice
    ranking: aerocues.Ranking
    tested: bool
    """Whether the test is about the choice: other objectives weigh other criteria."""

    @property
    def probability(self) -> str:
        """That the choice is the best; nothing with a single pair."""
        first = self.choice.ranked["probability"][0]
        return "" if first is None else likelihood(float(first))

    @property
    def not_worse(self) -> list[str]:
        """The others that are not significantly worse (p >= .05)."""
        compared = set(self.choice.ranked["combination"])
        return [name for name in self.ranking.indistinguishable() if name in compared]

    def sentence(self, title: str) -> str:
        """What it says of a condition, with the interval and how sure it is."""
        best, others = self.choice.best, len(self.choice.ranked) - 1
        row = self.ranking.frame("combination").row(0, named=True)
        interval = f"(95 % interval {row['score_low']:.2f} to {row['score_high']:.2f})"
        pairs, score = count(self.choice.pairs, "pair"), f"{row['score']:.2f}"
        told = (
            f"a score of {score} {interval}, where 1 is the best pair of all and all pairs are "
            f"surely linked, over {pairs}; the probability that it is the best is "
            f"{self.probability}"
        )
        title, worse = f"{title[0].upper()}{title[1:]}", len(self.not_worse)
        if 2 * worse >= others:
            return (
                f"**{title}: nothing is decided.** {best} has the highest score: {told}. But "
                f"{worse:,} of the {others:,} others are not significantly worse (p ≥ .05)."
            )
        named = f": {', '.join(self.not_worse[:MOST_NAMED])}" if worse else ""
        more = f" and {worse - MOST_NAMED} more" if worse > MOST_NAMED else ""
        place = "has the highest score" if worse else "is the best"
        return (
            f"**{title}: {best}** {place} of {others + 1:,} combinations: {told}. Not "
            f"significantly worse (p ≥ .05): {worse or 'none'} of the {others:,} others"
            f"{named}{more}."
        )


@dataclass(frozen=True)
class Answers(Models, Losses):
    """Statements for the first screens."""

    def measured(self) -> str:
        """How much there is."""
        if self.study is None:
            return NOT_YET
        parts = self.study.parts()
        rows, models = int(parts["rows"].sum()), int(parts["models"].sum())
        failed = rows - int(parts["ok"].sum())
        most = parts.select(pl.max("combinations")).item()
        table = self.study.table()
        timed = int((table["timing"] == "exclusive").sum())
        return (
            f"So far: {count(rows, 'row')} in {count(len(parts), 'part')}, of which "
            f"{failed:,} failed or are not better than chance, and "
            f"{count(models, 'reconstruction')}; up to {most} of 340 combinations a part; "
            f"{parts['cpu_hours'].sum():.2f} CPU hours for {parts['covered'].sum():,} of these "
            "(of the others none are known). "
            f"{count(timed, 'row')} timed alone; the times of others are scaled by these or, where "
            f"these failed, estimated. {count(int(parts['again'].sum()), 'row')} measured again: "
            f"{parts['identical'].sum():,} with identical quality."
            f"{self._outdated(table)}{_mixed(table)}"
        )

    def _outdated(self, table: pl.DataFrame) -> str:
        """How many rows have other parameters than their preset has by now."""
        parts = {step.part.name: step.part for step in read_plan().steps}
        rows = [table.filter(pl.col("part") == name) for name in parts]
        number = sum(map(len, map(outdated_rows, rows, parts.values())))
        told = "with parameters that their preset had before: the next `make study` replaces them"
        return f" {count(number, 'row')} {told}." if number else ""

    @cached_property
    def findings(self) -> Mapping[str, Finding]:
        """What is known of each condition of which the part was measured."""
        found = {}
        for title, name, aim in CONDITIONS:
            for results in self.results([name]):
                choice = aerocues.choose(results, aim)
                ranking = aerocues.score(results, choice.presets[0], reconstruction=False)
                tested = aim == TESTED and ranking.against == choice.best
                found[title] = Finding(choice, ranking, tested)
        return found

    def main_finding(self) -> str:
        """The first condition that was measured, with its interval, and the model of its best."""
        parts = {title: name for title, name, _ in CONDITIONS}
        for title, finding in self.findings.items():
            built = self.built(parts[title])
            told = f" {built.of_the_best(finding.choice.best)}" if built else ""
            return finding.sentence(title) + told
        return NOT_YET

    def advice(self) -> str:
        """What to take under each condition."""
        lines = [("you fly", "take", "probability", "not significantly worse", "measured")]
        for title, _, _ in CONDITIONS:
            if (found := self.findings.get(title)) is None:
                lines.append((title, NOT_YET, "", "", ""))
                continue
            others = found.not_worse if found.tested else []
            named = ", ".join(f"`{each}`" for each in others[:MOST_NAMED])
            more = f" and {len(others) - MOST_NAMED} more" if others[MOST_NAMED:] else ""
            number = f"{len(others)}: {named}{more}" if others else "none"
            choice = found.choice
            on = f"{len(choice.ranked)} combinations, {choice.pairs} pairs"
            worse = number if found.tested else "not tested"
            lines.append((title, f"`{choice.best}`", found.probability, worse, on))
        return markdown(lines)

    def changes(self) -> str:
        """How many conditions have a best of their own."""
        if len(self.findings) < 2:
            return NOT_YET
        bests = dict.fromkeys(each.choice.best for each in self.findings.values())
        named = ", ".join(f"`{best}`" for best in bests)
        return (
            f"The {len(self.findings)} measured conditions have "
            f"{count(len(bests), 'combination', 'different combinations')}: {named}."
        )

    def binary(self) -> str:
        """The best binary combinations under 50 ms."""
        found = self.table("binary")
        if found.is_empty():
            return f"{console('binary')}\n\n{NOT_YET}"
        lines: list[tuple[str, ...]] = [
            ("combination", "pairs", "coverage", "pairs ok", "ms an image", "ms to match a pair")
        ]
        for row in found.iter_rows(named=True):
            name = f"`{row['detector']}-{row['descriptor']}-HAM-{row['matcher']}`"
            times = (f"{row[each] * 1e3:.0f}" for each in ("seconds", "to_match"))
            shares = (f"{row['coverage']:.3f}", f"{row['ok']:.0%}")
            lines.append((name, str(row["pairs"]), *shares, *times))
        return f"{console('binary')}\n\n{markdown(lines)}"

    def flann(self) -> str:
        """Brute force against FLANN at 8,000 keypoints."""
        found = self.table("flann")
        if found.is_empty():
            return f"{console('flann')}\n\n{NOT_YET}"
        heads = ("CPU s to match", "CPU s of one image and one pair", "right matches a pair")
        lines: list[tuple[str, ...]] = [("descriptors", "matcher", "rows", *heads)]
        told = []
        for row in found.iter_rows(named=True):
            seconds = (f"{row[each]:.2f}" for each in ("seconds", "in_all"))
            right, kind = f"{row['right_matches']:.0f}", KINDS[row["norm"]]
            lines.append((kind, row["matcher"], str(row["pairs"]), *seconds, right))
        for norm, kind in KINDS.items():
            own = {row["matcher"]: row for row in found.filter(norm=norm).iter_rows(named=True)}
            if {"BF", "FLANN"} <= own.keys() and own["BF"]["right_matches"] > 0:
                told.append(_verdict(kind, own["BF"], own["FLANN"]))
        return f"{console('flann')}\n\n{' '.join(told)}\n\n{markdown(lines)}"
