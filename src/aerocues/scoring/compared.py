"""Several results compared: rankings across datasets, runs over the same images."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from aerocues.errors import ScoreError
from aerocues.notebooks import as_html
from aerocues.phrases import count
from aerocues.scoring.across import Entry, compare_datasets, times_between
from aerocues.scoring.comparison import Comparison, Over
from aerocues.scoring.joint import JointScores, score_jointly
from aerocues.scoring.platforms import device_factors
from aerocues.scoring.validation import correlation_frame

if TYPE_CHECKING:
    import polars as pl


@dataclass(frozen=True)
class Runs:
    """Two runs over the same dataset.

    Attributes
    ----------
    first, second : Entry
    joint : JointScores or str
        Both scored together; a text says why they cannot be.
    times : pl.DataFrame or str
        See `platforms.compare_times`; a text says why times cannot be compared.
    """

    first: Entry
    second: Entry
    joint: JointScores | str
    times: pl.DataFrame | str


@dataclass(frozen=True)
class ComparedResults:
    """Rankings side by side, and runs over the same images scored together.

    Attributes
    ----------
    entries : sequence of Entry
        What was scored: each dataset as each machine measured it.
    rankings : Comparison
        Of all entries, each normalised by itself.
    runs : sequence of Runs
        The first entry of each dataset with each other one of it.
    """

    entries: Sequence[Entry]
    rankings: Comparison
    runs: Sequence[Runs]

    def __repr__(self) -> str:
        names = ", ".join(entry.name for entry in self.entries)
        return f"ComparedResults: {count(len(self.entries), 'ranking')}, {names}"

    def _repr_html_(self) -> str:
        return as_html(repr(self), self.frame())

    @property
    def of_one_dataset(self) -> bool:
        """Whether all entries are runs over the same dataset."""
        return len({entry.dataset for entry in self.entries}) == 1

    def frame(self) -> pl.DataFrame:
        """One row a combination: differences of two runs, or scores and ranks across datasets.

        Returns
        -------
        pl.DataFrame
            Of two runs over the same images: see `JointScores.differences`. Otherwise
            ``combination``; ``mean, min, spread`` of the scores; ``mean_rank, worst_rank``; and
            ``score_NAME, rank_NAME`` of each entry, the most versatile first.
        """
        if len(self.entries) == 2 and self.runs and not isinstance(self.runs[0].joint, str):
            return self.runs[0].joint.differences()
        return self.rankings.versatility().rename({"alternative": "combination"})

    def tables(self) -> dict[str, pl.DataFrame]:
        """All tables by their titles, for a paper."""
        found = {
            "Spearman's rank correlation": correlation_frame(
                self.rankings.names, self.rankings.spearman()
            ),
            "Kendall's rank correlation": correlation_frame(
                self.rankings.names, self.rankings.kendall()
            ),
        }
        if not self.of_one_dataset:
            frame = self.rankings.versatility().rename({"alternative": "combination"})
            found["Versatility"] = frame.drop(
                name for name in frame.columns if name.startswith(("rank_", "standard_"))
            )
        for each in self.runs:
            between = f"{each.second.name} (second) against {each.first.name} (first)"
            if not isinstance(each.joint, str):
                found[f"CUES of {between}"] = each.joint.differences()
                found[f"Criteria of {between}"] = each.joint.criteria()
            if not isinstance(each.times, str):
                found[f"Times of {between}"] = each.times
        return found

    def factors(self) -> dict[str, object]:
        """How much longer each stage takes on the second machine: for ``recommend(device=)``.

        Raises
        ------
        ScoreError
            If these are not two entries of one dataset.
        """
        if len(self.entries) != 2 or not self.of_one_dataset:
            raise ScoreError("`factors` needs two results of the same dataset, from two machines")
        here, there = self.entries
        return {
            "machine": there.machine,
            "measured_on": here.machine,
            "dataset": here.dataset,
            "stages": device_factors(here.rows, there.rows),
        }


def compare_entries(
    entries: Sequence[Entry], over: Over = "pairwise", *, test: str = "bootstrap", seed: int = 0
) -> ComparedResults:
    """Compare all entries, and those of one dataset with its first one."""
    first_of: dict[str, Entry] = {}
    runs = []
    for entry in entries:
        first = first_of.setdefault(entry.dataset, entry)
        if first is not entry:
            joint = _joint(first, entry, test, seed)
            runs.append(Runs(first, entry, joint, times_between(first, entry)))
    return ComparedResults(entries, compare_datasets(entries, over), runs)


def _joint(first: Entry, second: Entry, test: str, seed: int) -> JointScores | str:
    try:
        return score_jointly(first, second, test=test, seed=seed)
    except ScoreError as error:
        return str(error)
