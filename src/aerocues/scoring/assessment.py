"""Measured results scored, validated and compared, as users of the library ask for it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import get_args

from aerocues.arguments import check_choice, check_whole
from aerocues.defaults import RESAMPLES, SHORTLIST, TOP_K
from aerocues.scoring.across import Stored, entries_of
from aerocues.scoring.compared import ComparedResults, compare_entries
from aerocues.scoring.comparison import Over
from aerocues.scoring.cues import score as scores_of
from aerocues.scoring.measured import Measured, opened, settings_from, table_of
from aerocues.scoring.ranking import Interval, Ranking, rank_alternatives
from aerocues.scoring.settings import Failures, Names
from aerocues.scoring.validation import Validation
from aerocues.scoring.validation import validate as examine


def score(
    results: Measured | str | Path,
    preset: str | None = None,
    *,
    criteria: Names | None = None,
    dataset: str | None = None,
    reconstruction: bool | None = None,
    failures: Failures | None = None,
    alpha: float | None = None,
    weights: Names | None = None,
    aggregation: str | None = None,
    resamples: int = RESAMPLES,
    seed: int = 0,
    interval: Interval = "joint",
    test: str = "bootstrap",
    top_k: int = TOP_K,
    against: str | None = None,
) -> Ranking:
    """Rank the combinations of measured results by CUES.

    Parameters
    ----------
    results : Results or path
        A results folder or packed results.
    preset : str, optional
        ``default`` (right matches by references of the pairs, times links), ``inliers``,
        ``models`` or ``thesis``; the one that suits the measurements by default.
    criteria : str or sequence of str, optional
        Names of rows of `criteria.CRITERIA`, in place of the preset's.
    dataset : str, optional
        Needed where there are several.
    reconstruction : bool, optional
        Whether to add the criteria of reconstruction; by default, where most combinations were
        reconstructed.
    failures : {"worst", "omit"}, optional
        What a failed pair counts as; by default as in the preset.
    alpha : float, optional
        Power of the normalised values, above 0; by default 0.5.
    weights : str or sequence of str, optional
        Methods of weighting, such as ``"entropy,critic"``; by default those of the preset.
    aggregation : {"arithmetic", "geometric", "harmonic", "trimmed"}, optional
        How the weights of the methods become one.
    resamples : int
        How often the pairs are drawn anew for intervals and probabilities; 2 or more.
    seed : int
        Of the resamples.
    interval : {"joint", "pairwise"}
        Interval of the score: from the joint resamples, or the thesis's.
    test : {"bootstrap", "wilcoxon"}
        Significance test.
    top_k : int
        Places that count for ``probability_top``.
    against : str, optional
        The combination that the others are tested against, such as one of your own; the best by
        default.

    Returns
    -------
    Ranking

    Raises
    ------
    AerocuesError
        If an argument makes no sense, or something does not exist or was not measured.
    """
    found = table_of(
        opened(results), preset, criteria=criteria, dataset=dataset, reconstruction=reconstruction
    )
    settings = settings_from(
        found.preset, failures=failures, alpha=alpha, weights=weights, aggregation=aggregation
    )
    return rank_alternatives(
        found.table,
        settings,
        resamples=resamples,
        seed=seed,
        interval=interval,
        test=test,
        top_k=top_k,
        noun="combination",
        against=against,
    )


def validate(
    results: Measured | str | Path,
    preset: str | None = None,
    *,
    criteria: Names | None = None,
    dataset: str | None = None,
    reconstruction: bool | None = None,
    failures: Failures | None = None,
    alpha: float | None = None,
    weights: Names | None = None,
    aggregation: str | None = None,
    speed: str | None = None,
    quality: str | None = None,
    top: int = SHORTLIST,
    seed: int = 0,
) -> Validation:
    """Tell how far a ranking can be trusted.

    How it changes with each choice, what other methods of decision make of the same values, and
    what the measurements behind it are like.

    Parameters
    ----------
    results, preset, criteria, dataset, reconstruction, failures, alpha, weights, aggregation
        What is scored, and how; see `score`.
    speed, quality : str, optional
        Criteria of the Pareto front; by default the first of the usual ones that were measured.
    top : int
        How many of the best take part in Friedman's test; 2 or more.
    seed : int
        Of what is drawn.

    Returns
    -------
    Validation

    Raises
    ------
    AerocuesError
        If an argument makes no sense, or something does not exist or was not measured.
    """
    found = table_of(
        opened(results), preset, criteria=criteria, dataset=dataset, reconstruction=reconstruction
    )
    settings = settings_from(
        found.preset, failures=failures, alpha=alpha, weights=weights, aggregation=aggregation
    )
    check_whole("top", top, 2)
    scores = scores_of(found.table, settings)
    return examine(scores, speed=speed, quality=quality, shortlist=top, seed=seed)


def compare(
    results: Sequence[Stored | str | Path],
    preset: str | None = None,
    *,
    criteria: Names | None = None,
    reconstruction: bool = False,
    failures: Failures | None = None,
    alpha: float | None = None,
    weights: Names | None = None,
    aggregation: str | None = None,
    over: Over = "pairwise",
    test: str = "bootstrap",
    seed: int = 0,
) -> ComparedResults:
    """Compare rankings across datasets, and runs over the same images.

    Two runs over the same images, under two presets, versions or machines, are scored together,
    with one normalisation, and every difference is tested.

    Parameters
    ----------
    results : sequence of Results or paths
        Each dataset in each of them, and each machine, is one ranking.
    preset, criteria, failures, alpha, weights, aggregation
        How they are scored; see `score`.
    reconstruction : bool
        Whether to add the criteria of reconstruction to the datasets that have models.
    over : {"pairwise", "all"}
        Compare two rankings over the combinations scored in both, or in all.
    test : {"bootstrap", "wilcoxon"}
        Paired test of two runs over the same images.
    seed : int
        Of the resamples behind that test.

    Returns
    -------
    ComparedResults

    Raises
    ------
    AerocuesError
        If an argument makes no sense, or one of the results cannot be scored.
    """
    check_choice("over", over, get_args(Over))
    entries = entries_of(
        [opened(each) for each in results],
        preset,
        criteria=criteria,
        reconstruction=reconstruction,
        failures=failures,
        alpha=alpha,
        weights=weights,
        aggregation=aggregation,
    )
    return compare_entries(entries, over, test=test, seed=seed)
