"""Any figure of the page as a Plotly figure."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from aerocues.arguments import check_choice, check_whole
from aerocues.defaults import RESAMPLES
from aerocues.errors import ArgumentError, MethodUnavailableError, ScoreError
from aerocues.methods.selection import Patterns, split_names
from aerocues.pipeline.two_images import MatchedImages
from aerocues.report.entry import ReportEntry
from aerocues.report.interactive import models, pictures, quality, relations, score, times
from aerocues.report.interactive.view import View
from aerocues.report.report import listed, report_entries
from aerocues.results.measured_results import Results
from aerocues.scoring.settings import Failures, Names

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

TOP = 20

# Each gives a figure, or why the data have nothing of the kind.
SECTIONS: Mapping[str, Callable[[View], Figure | str]] = {
    "cues": score.cues,
    "heat-maps": score.heat_maps,
    "weights": score.weights,
    "pareto": score.pareto,
    "components": score.components,
    "distributions": quality.distributions,
    "precision-recall": quality.precision_recall,
    "inliers-matches": quality.inliers_matches,
    "curves": quality.curves,
    "ground-truth": quality.ground_truth,
    "ground-truth-correlations": quality.ground_truth_correlations,
    "times": times.times,
    "times-per-thousand": times.times_per_thousand,
    "times-by-method": times.times_by_method,
    "matchers": times.matchers,
    "machines": times.machines,
    "criteria": relations.criteria,
    "sensitivity": relations.sensitivity,
    "agreement": relations.agreement,
    "critical-difference": relations.critical_difference,
    "rankings": relations.rankings,
    "ranks": relations.ranks,
    "matches": pictures.matches,
    "models": models.models,
    "models-relation": models.models_relation,
    "outcomes": models.outcomes,
    "cloud-distances": models.cloud_distances,
    "cloud": models.cloud,
}


def figure(
    results: Results | str | Path | MatchedImages | Sequence[Results | str | Path],
    section: str = "cues",
    *,
    combinations: Patterns | None = None,
    dataset: str | None = None,
    top: int = TOP,
    pair: int | None = None,
    column: str | None = None,
    preset: str | None = None,
    criteria: Names | None = None,
    reconstruction: bool | None = None,
    failures: Failures | None = None,
    alpha: float | None = None,
    weights: Names | None = None,
    aggregation: str | None = None,
    resamples: int = RESAMPLES,
    seed: int = 0,
) -> Figure:
    """Draw a figure of the report's page, to show in a notebook or to change further.

    Parameters
    ----------
    results : Results, path, sequence of them, or MatchedImages
        Of one or several datasets and machines; what `aerocues.match` found shows its matches.
    section : str
        Of the scores: ``cues, heat-maps, weights, pareto, components``; of quality:
        ``distributions, precision-recall, inliers-matches, curves, ground-truth,
        ground-truth-correlations``; of times: ``times, times-per-thousand, times-by-method,
        matchers, machines``; of the ranking: ``criteria, sensitivity, agreement,
        critical-difference``; of several rankings: ``rankings, ranks``; ``matches``; of 3D models:
        ``models, models-relation, outcomes, cloud-distances, cloud``.
    combinations : str, Combination or iterable of both, optional
        Globs of the combinations to show; ``matches`` and ``cloud`` show the best of them.
    dataset : str, optional
        Which of several to show; the first by default.
    top : int
        How many combinations to show where all do not fit.
    pair : int, optional
        Number of the pair of ``matches``; the first by default.
    column : str, optional
        What ``distributions`` and ``curves`` show, such as ``"inliers"``.
    preset, criteria, reconstruction, failures, alpha, weights, aggregation, resamples, seed
        How combinations are scored; see `aerocues.score`.

    Returns
    -------
    plotly.graph_objects.Figure

    Raises
    ------
    AerocuesError
        If an argument makes no sense, the results cannot be scored, or hold nothing of the kind.
    """
    check_choice("section", section, SECTIONS)
    check_whole("top", top, 1)
    _require_plotly()
    if isinstance(results, MatchedImages):
        return pictures.matches_of(results)
    entries = report_entries(
        listed(results),
        preset,
        criteria=criteria,
        reconstruction=reconstruction,
        resamples=resamples,
        seed=seed,
        failures=failures,
        alpha=alpha,
        weights=weights,
        aggregation=aggregation,
    )
    found = _chosen_entry(entries, dataset)
    view = View(entries, found, _positions(found, combinations), top, pair, column)
    drawn = SECTIONS[section](view)
    if isinstance(drawn, str):
        raise ScoreError(f"there is nothing to show of {section} for {found.name}: {drawn}")
    return drawn


def _require_plotly() -> None:
    try:
        import plotly  # noqa: F401
    except ImportError as error:
        raise MethodUnavailableError(
            f"figures need plotly ({error}); install it: pip install plotly"
        ) from error


def _chosen_entry(entries: Sequence[ReportEntry], dataset: str | None) -> ReportEntry:
    if dataset is None:
        return entries[0]
    names = [found.entry.dataset for found in entries]
    check_choice("dataset", dataset, dict.fromkeys(names))
    return entries[names.index(dataset)]


def _positions(found: ReportEntry, combinations: Patterns | None) -> np.ndarray:
    """Scored combinations that match, the best first."""
    from fnmatch import fnmatchcase

    order = found.ranking.scores.order
    globs = split_names(combinations)
    if not globs:
        return order
    names = found.combinations
    kept = [i for i in order if any(fnmatchcase(names[i], glob) for glob in globs)]
    if not kept:
        raise ArgumentError(f"`combinations` match none of the {len(order)} that have a score")
    return np.array(kept, dtype=np.int64)
