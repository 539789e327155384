"""The best combination for a purpose, from finished measurements, within limits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from aerocues.arguments import (
    check_choice,
    check_positive,
    check_whole,
    megabytes_of,
    seconds_of,
)
from aerocues.defaults import RESAMPLES
from aerocues.errors import ArgumentError, ScoreError
from aerocues.methods.licences import why_not_licensed
from aerocues.methods.selection import Patterns, select_measured
from aerocues.notebooks import as_html
from aerocues.phrases import count, likelihood
from aerocues.results.combination_columns import COMBINATION
from aerocues.scoring.constraints import LIMITS, costs_of, exceeded
from aerocues.scoring.finished import FinishedScores, scores_of_finished
from aerocues.scoring.measured import Measured, opened, refuse_repeated, rows_of_dataset
from aerocues.scoring.objectives import OBJECTIVES, Objective
from aerocues.scoring.valuation import chances

if TYPE_CHECKING:
    import polars as pl

Array = NDArray[np.float64]
LEAST_SHARE = 0.5
"""Share of the pairs of a dataset on which a combination must have been measured."""
MEASURE = "measure them on all pairs with `aerocues.run`"
ASK = "take out fewer combinations"
ALLOW = "allow more"


@dataclass(frozen=True, eq=False)
class Choice:
    """What finished measurements say for a purpose.

    Attributes
    ----------
    objective : Objective
    datasets : tuple of str
    presets : tuple of str
        Scoring preset of each dataset.
    pairs : int
        Of all datasets.
    ranked : pl.DataFrame
        One row per combination within the limits, the best first: ``combination, score,
        probability`` (of being the best of them; null with a single pair), ``success_rate``, what
        is limited (see `constraints.LIMITS`) and, with several datasets, ``score_NAME``.
    excluded : mapping of str to str
        Why each other combination was left out.
    """

    objective: Objective
    datasets: tuple[str, ...]
    presets: tuple[str, ...]
    pairs: int
    ranked: pl.DataFrame
    excluded: Mapping[str, str]

    @property
    def best(self) -> str:
        """The combination to take."""
        return str(self.ranked[COMBINATION][0])

    def __repr__(self) -> str:
        chance = self.ranked["probability"][0]
        told = "" if chance is None else f" with a probability of {likelihood(float(chance))}"
        return (
            f"Choice: take {self.best}, the best of {len(self.ranked):,} for "
            f"{self.objective.title} on {count(self.pairs, 'pair')}{told}"
        )

    def _repr_html_(self) -> str:
        return as_html(repr(self), self.ranked)


def choose(
    results: Measured | str | Path | Sequence[Measured | str | Path],
    objective: str = "balanced",
    *,
    combinations: Patterns | None = None,
    dataset: str | None = None,
    max_seconds_per_image: float | str | None = None,
    max_memory: float | str | None = None,
    max_descriptor_bytes: float | None = None,
    licence: str | None = None,
    resamples: int = RESAMPLES,
    seed: int = 0,
) -> Choice:
    """Choose a combination from finished measurements, without measuring anything.

    Each dataset is scored by itself, over all combinations measured on it; a failed pair counts as
    the worst. Scores of several datasets are averaged (objectives of a share of the scenes: over
    that share of the datasets). Limits leave combinations out and do not change scores.

    Parameters
    ----------
    results : Results, path, or sequence of them
    objective : str
        A row of `objectives.OBJECTIVES`.
    combinations : str, Combination or iterable of both, optional
        Patterns such as ``"ORB-*,!*-FLANN"``: only these may be chosen. Wildcards take methods on
        request, too, where they were measured.
    dataset : str, optional
        Only this dataset counts; all of them by default.
    max_seconds_per_image : float or str, optional
        Median time for one image and one pair: seconds, or a text such as ``"50ms"``.
    max_memory : float or str, optional
        Largest increase of memory in one stage: megabytes, or a text such as ``"300MB"``.
    max_descriptor_bytes : float, optional
        Bytes of one descriptor.
    licence : {"permissive"}, optional
        Which licences the code of the methods may have.
    resamples, seed : int
        Of the probabilities: pairs (whole sequences where there are enough) are drawn anew.

    Returns
    -------
    Choice

    Raises
    ------
    AerocuesError
        If an argument makes no sense, something was not measured, or no combination is left.
    """
    check_choice("objective", objective, OBJECTIVES)
    check_whole("resamples", resamples, 2)
    check_whole("seed", seed, 0)
    most: dict[str, float] = {}
    if max_seconds_per_image is not None:
        most["max_seconds_per_image"] = seconds_of("max_seconds_per_image", max_seconds_per_image)
    if max_memory is not None:
        most["max_memory"] = megabytes_of("max_memory", max_memory)
    if max_descriptor_bytes is not None:
        check_positive("max_descriptor_bytes", max_descriptor_bytes)
        most["max_descriptor_bytes"] = max_descriptor_bytes
    rows = _datasets(results, dataset)
    aim = OBJECTIVES[objective]
    scored = [scores_of_finished(each, aim, resamples, seed) for each in rows]
    costs = _worst_costs(rows)
    excluded = _excluded(scored, costs, most, combinations, licence)
    kept = [name for name in scored[0].alternatives if name not in excluded]
    return Choice(
        objective=aim,
        datasets=tuple(each.dataset for each in scored),
        presets=tuple(each.preset for each in scored),
        pairs=sum(each.pairs for each in scored),
        ranked=_ranked(scored, kept, aim).join(costs, on=COMBINATION, maintain_order="left"),
        excluded=excluded,
    )


def _excluded(
    scored: Sequence[FinishedScores],
    costs: pl.DataFrame,
    most: Mapping[str, float],
    combinations: Patterns | None,
    licence: str | None,
) -> dict[str, str]:
    """Why combinations are left out; the first reason counts. ScoreError if all are."""
    names = list(dict.fromkeys(name for each in scored for name in each.alternatives))
    steps = [
        (MEASURE, _not_everywhere(scored, names)),
        (MEASURE, _hardly_measured(scored)),
        (ASK, _unnamed(names, combinations)),
        (ALLOW, exceeded(costs, most)),
        (ALLOW, {} if licence is None else why_not_licensed(names, licence)),
    ]
    found: dict[str, str] = {}
    remedies: dict[str, str] = {}
    for remedy, reasons in steps:
        new = {name: why for name, why in reasons.items() if name not in found}
        for name, why in list(new.items())[:1]:
            remedies[remedy] = f"{name}: {why}"
        found |= new
    if len(found) == len(names):
        raise ScoreError(_none_left(len(found), remedies))
    return found


def _none_left(number: int, remedies: dict[str, str]) -> str:
    """What to do; asking for more helps only where nothing else keeps combinations out."""
    told = {each: why for each, why in remedies.items() if each != ASK} or remedies
    left = "is within the limits" if ALLOW in told else "is left"
    example = list(told.values())[-1]
    return f"no combination {left} ({number:,} left out, such as {example}); {' or '.join(told)}"


def _datasets(
    results: Measured | str | Path | Sequence[Measured | str | Path], dataset: str | None
) -> list[pl.DataFrame]:
    listed = (
        results if isinstance(results, Sequence) and not isinstance(results, str) else [results]
    )
    if not listed:
        raise ArgumentError("`results` is empty; give at least one result")
    measured = [opened(each) for each in listed]
    refuse_repeated(measured)
    tables = [each.table() for each in measured]
    if dataset is not None:
        return [rows_of_dataset(table, dataset) for table in tables]
    return [rows for table in tables for _, rows in table.group_by("dataset", maintain_order=True)]


def _labels(scored: Sequence[FinishedScores]) -> list[str]:
    """The datasets, numbered where results have the same."""
    names = [each.dataset for each in scored]
    if len(set(names)) == len(names):
        return names
    return [f"{number} {name}" for number, name in enumerate(names, start=1)]


def _not_everywhere(scored: Sequence[FinishedScores], names: Sequence[str]) -> dict[str, str]:
    labelled = list(zip(_labels(scored), scored, strict=True))
    lacking = {name: [label for label, each in labelled if name not in each] for name in names}
    return {name: f"not measured on {', '.join(on)}" for name, on in lacking.items() if on}


def _hardly_measured(scored: Sequence[FinishedScores]) -> dict[str, str]:
    """What was measured on few pairs, as a race leaves most combinations, is not comparable."""
    return {
        each.alternatives[position]: f"measured on fewer than half of the pairs of {label}"
        for label, each in zip(_labels(scored), scored, strict=True)
        for position in np.flatnonzero(each.measured_share < LEAST_SHARE)
    }


def _unnamed(names: Sequence[str], patterns: Patterns | None) -> dict[str, str]:
    if patterns is None:
        return {}
    from aerocues.methods.plugins import installed_methods

    chosen = select_measured(installed_methods(), patterns, names)
    return {name: "not among the combinations asked for" for name in names if name not in chosen}


def _worst_costs(rows: Sequence[pl.DataFrame]) -> pl.DataFrame:
    """The largest cost of each combination over the datasets; unknown if it is on one of them."""
    import polars as pl

    found = pl.concat([costs_of(each) for each in rows])
    names = [limit.column for limit in LIMITS]
    return found.group_by(COMBINATION, maintain_order=True).agg(
        pl.when(pl.col(name).is_not_null().all()).then(pl.col(name).max()).alias(name)
        for name in names
    )


def _ranked(
    scored: Sequence[FinishedScores], kept: Sequence[str], objective: Objective
) -> pl.DataFrame:
    import polars as pl

    places = [[each.alternatives.index(name) for name in kept] for each in scored]
    own = np.stack([each.scores[at] for each, at in zip(scored, places, strict=True)])
    drawn = np.stack([each.drawn[:, at] for each, at in zip(scored, places, strict=True)])
    success = [each.success_rate[at] for each, at in zip(scored, places, strict=True)]
    single = {f"score_{name}": row for name, row in zip(_labels(scored), own, strict=True)}
    over_sets = np.array([objective.over_blocks(each.T) for each in drawn.transpose(1, 0, 2)])
    known = any(each.units > 1 for each in scored)
    return pl.DataFrame(
        {
            COMBINATION: kept,
            "score": objective.over_blocks(own.T),
            "probability": chances(over_sets) if known else [None] * len(kept),
            "success_rate": np.mean(success, axis=0),
            **(single if len(scored) > 1 else {}),
        },
        schema_overrides={"probability": pl.Float64},
    ).sort("score", COMBINATION, descending=[True, False])
