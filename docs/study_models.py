"""Which combinations build the best models, as Markdown; see docs/study.py."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import polars as pl

import aerocues
from aerocues.phrases import count
from aerocues.results.combination_columns import COMBINATION, combination_name
from aerocues.results.model_quality import MODEL_QUALITY
from aerocues.results.reconstruction_schema import BASELINE
from docs.study_parts import NOT_YET, Parts
from docs.study_queries import console, markdown

ENOUGH = 20
"""Of fewer models, a place tells little."""
SHOWN = 3
FIGURES = {
    "points_in_3_images": ("points", ",.0f"),
    "reprojection_error": ("error, px", ".2f"),
    "position_rmse": ("cameras off, m", ".2f"),
    "surface_error": ("surface off, m", ".3f"),
    "reconstruction_seconds": ("CPU s", ".0f"),
    MODEL_QUALITY: ("quality", ".0f"),
}
COLMAP_DEFAULT = str(BASELINE)


@dataclass(frozen=True)
class Built:
    """The models of a part, the best first, and what its pairs alone choose."""

    part: str
    models: pl.DataFrame
    choice: str

    @property
    def number(self) -> int:
        """How many combinations have a model, COLMAP's default aside."""
        others = self.models.filter(pl.col(COMBINATION) != COLMAP_DEFAULT)
        return int((others[MODEL_QUALITY] > 0).sum())

    def place(self, combination: str) -> int:
        """The place of the model of a combination."""
        return self.models[COMBINATION].to_list().index(combination) + 1

    def share(self, combination: str) -> float:
        """The quality of its model, as a share of that of the best."""
        quality = self.models[MODEL_QUALITY]
        return float(quality[self.place(combination) - 1] / quality[0])

    def lines(self) -> list[tuple[str, ...]]:
        """A row for each of the first models, that of COLMAP's default and that of the choice."""
        others = (COLMAP_DEFAULT, self.choice)
        shown = (pl.col("place") <= SHOWN) | pl.col(COMBINATION).is_in(others)
        placed = self.models.with_row_index("place", offset=1)
        return [self._line(row) for row in placed.filter(shown).iter_rows(named=True)]

    def _line(self, row: Mapping[str, Any]) -> tuple[str, ...]:
        figures = (
            "" if row[name] is None else f"{row[name]:{style}}"
            for name, (_, style) in FIGURES.items()
        )
        images = f"{row['placed_images']} of {row['images']}"
        name = row[COMBINATION]
        told = "COLMAP's default" if name == COLMAP_DEFAULT else f"`{name}`"
        return f"`{self.part}`", str(row["place"]), told, images, *figures

    def of_the_best(self, combination: str) -> str:
        """How good the model of a combination is, which the pairs say is the best."""
        if combination not in (names := self.models[COMBINATION].to_list()):
            return ""
        return (
            f"Of the {self.number} of these that have a model, its model has place "
            f"{self.place(combination)}, with {self.share(combination):.0%} of the quality of the "
            f"best, that of {names[0]}; COLMAP's default has place {self.place(COLMAP_DEFAULT)}."
        )

    def sentence(self) -> str:
        """How many are better than COLMAP's default, and how good the choice of the pairs is."""
        place, number = self.place(self.choice), self.number
        better = self.place(COLMAP_DEFAULT) - 1
        return (
            f"`{self.part}`: {better} of {count(number, 'combination')} with a model have a better "
            f"one than COLMAP's default; what the pairs choose of them, `{self.choice}`, has place "
            f"{place}, with {self.share(self.choice):.0%} of the quality of the best."
            f"{self._refined()}"
        )

    def _refined(self) -> str:
        """By how much COLMAP's default changes the focal length that it begins with."""
        lengths = dict(self.models.select(COMBINATION, "focal_length").iter_rows())
        before, after = lengths[self.choice], lengths[COLMAP_DEFAULT]
        if before is None or after is None:
            return ""
        return f" COLMAP's default refines the focal length from {before:,.0f} to {after:,.0f} px."


@dataclass(frozen=True)
class Models(Parts):
    """Statements about the models that were built with every combination."""

    def models_finding(self) -> str:
        """How good the models are that pairs choose, and COLMAP's default, over all flights."""
        every = self._every
        if not every:
            return NOT_YET
        chosen = ", ".join(str(built.place(built.choice)) for built in every)
        default = ", ".join(str(built.place(COLMAP_DEFAULT)) for built in every)
        number = ", ".join(str(built.number) for built in every)
        parts = ", ".join(f"`{built.part}`" for built in every)
        tried = ", ".join(dict.fromkeys(str(len(built.models) - 1) for built in every))
        least = min(built.share(built.choice) for built in every)
        return (
            f"COLMAP's mapper was given the matches of {tried} combinations on {parts}: {number} "
            f"of them have a model. What the pairs alone choose has the places {chosen}, with "
            f"{least:.0%} of the quality of the best model or more; COLMAP's default has the "
            f"places {default}."
        )

    def models(self) -> str:
        """The best models of each flight beside COLMAP's default."""
        every = self._every
        if not every:
            return f"{console('models')}\n\n{NOT_YET}"
        heads = ("part", "place", "model", "images in place")
        lines = [(*heads, *(label for label, _ in FIGURES.values()))]
        told = "\n".join(f"- {built.sentence()}" for built in every)
        table = markdown([*lines, *(line for built in every for line in built.lines())])
        return f"{console('models')}\n\n{told}\n\n{table}"

    @cached_property
    def _every(self) -> list[Built]:
        return [built for name in self.names if (built := self.built(name)) is not None]

    def built(self, name: str) -> Built | None:
        """The models of a part; None where there are few of them."""
        [results] = self.results([name])
        models = results.reconstructions()
        if len(models) < ENOUGH:
            return None
        quality = pl.col(MODEL_QUALITY).fill_null(0.0)
        models = models.with_columns(combination_name(), quality)
        models = models.sort(MODEL_QUALITY, COMBINATION, descending=[True, False])
        built = set(models[COMBINATION])
        ranked = aerocues.choose(results, "reconstruction").ranked["combination"]
        choice = next((each for each in ranked if each in built), None)
        if choice is None or COLMAP_DEFAULT not in built:
            return None
        return Built(name, models, choice)
