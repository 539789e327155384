"""The parts of the study that are there, for the statements of its page; see docs/study.py."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import polars as pl

import aerocues
from aerocues.results.study_place import part_names
from docs.study_queries import QUERIES

REPOSITORY = Path(__file__).resolve().parent.parent
DATABASE = REPOSITORY / "study" / "database"
NOT_YET = "*Not measured yet.*"
MOST_NAMED = 4


@dataclass(frozen=True)
class Parts:
    """The database of the study."""

    place: Path = DATABASE

    @cached_property
    def study(self) -> aerocues.Study | None:
        """The database; None where nothing is in it."""
        return aerocues.Study(self.place) if part_names(self.place) else None

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
