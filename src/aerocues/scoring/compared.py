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
from aerocues.scoring.correlation import correlation_frame
from aerocues.scoring.joint import JointScores, score_jointly
from aerocues.scoring.overview import Overview, overview_of
from aerocues.scoring.platform_scores import PlatformScores, platform_scores
from aerocues.scoring.platforms import device_factors

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
    machines : PlatformScores, str or None
        Scores of two machines, each normalised by itself; None if the machine is the same, and a
        text says why they cannot be compared.
    """

    first: Entry
    second: Entry
    joint: JointScores | str
    times: pl.DataFrame | str
    machines: PlatformScores | str | None = None

    @property
    def title(self) -> str:
        """Which two runs these are."""
        return f"{self.second.name} (second) against {self.first.name} (first)"


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
    overview : Overview or None
        What the datasets say together; None for a single one.
    """

    entries: Sequence[Entry]
    rankings: Comparison
    runs: Sequence[Runs]
    overview: Overview | None = None

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
        found |= self.overview.tables() if self.overview else {}
        for each in self.runs:
            between = each.title
            if not isinstance(each.joint, str):
                found[f"CUES of {between}"] = each.joint.differences()
                found[f"Criteria of {between}"] = each.joint.criteria()
            if not isinstance(each.times, str):
                found[f"Times of {between}"] = each.times
            if isinstance(each.machines, PlatformScores):
                found |= each.machines.tables(between)
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
            runs.append(_runs(first, entry, test, seed))
    rankings = compare_datasets(entries, over)
    scores = [first.scores for first in first_of.values()]
    overview = overview_of(scores, rankings) if len(scores) > 1 else None
    return ComparedResults(entries, rankings, runs, overview)


def _runs(first: Entry, second: Entry, test: str, seed: int) -> Runs:
    return Runs(
        first=first,
        second=second,
        joint=_joint(first, second, test, seed),
        times=times_between(first, second),
        machines=platform_scores(first.scores, second.scores)
        if first.machine != second.machine
        else None,
    )


def _joint(first: Entry, second: Entry, test: str, seed: int) -> JointScores | str:
    try:
        return score_jointly(first, second, test=test, seed=seed)
    except ScoreError as error:
        return str(error)
