"""Correlates figures of image pairs with figures of the 3D reconstructions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import ScoreError
from aerocues.notebooks import as_html
from aerocues.results.combination_columns import COMBINATION, combination_name
from aerocues.results.model_quality import MODEL_QUALITY
from aerocues.scoring.combinations import SUCCESS, suitable_preset
from aerocues.scoring.correlation import correlation_between
from aerocues.scoring.criteria import Better
from aerocues.scoring.measured import Measured, opened, rows_of_dataset
from aerocues.scoring.pair_figures import figures_of_pairs
from aerocues.scoring.settings import score_preset_named

if TYPE_CHECKING:
    import polars as pl

Array = NDArray[np.float64]
# With three models, a random figure has a rank correlation of exactly 1 or -1 in one of three
# cases, with four in one of twelve: among dozens of coefficients, some would be 1 by chance.
FEWEST_MODELS = 5
# Reconstructions that ended without any image. Where a program failed, the outcome is unknown.
WITHOUT_MODEL = ("no_features", "no_verified_pair", "no_initial_pair", "no_model")


@dataclass(frozen=True)
class Outcome:
    """A figure of a reconstruction.

    Attributes
    ----------
    name : str
    better : {"higher", "lower"}
    of_model : bool
        Whether it describes a model. Then only successful reconstructions count: broken models
        have few points and a low reprojection error.
    to_reference : bool
        Whether it is a distance to a reference; the reference itself has none.
    """

    name: str
    better: Better = "higher"
    of_model: bool = True
    to_reference: bool = False


OUTCOMES: tuple[Outcome, ...] = (
    Outcome(MODEL_QUALITY, of_model=False),
    Outcome("registered_images", of_model=False),
    Outcome("points_3d"),
    Outcome("observations"),
    Outcome("mean_track_length"),
    Outcome("reprojection_error", "lower"),
    Outcome("position_rmse", "lower"),
    Outcome("rotation_error", "lower"),
    Outcome("surface_error", "lower"),
    Outcome("cloud_distance_rms", "lower", to_reference=True),
    Outcome("reference_distance_rms", "lower", to_reference=True),
    Outcome("reconstruction_seconds", "lower"),
)


@dataclass(frozen=True, eq=False)
class Relations:
    """Correlations over the combinations of figures of pairs with outcomes of reconstructions.

    Attributes
    ----------
    dataset : str
    combinations : tuple of str
        Combinations that were measured and reconstructed.
    features, outcomes : tuple of str
        Figures that vary.
    feature_values : (combinations, features) float64
        Means over the successful pairs, the share of these pairs, and, where pairs have a
        reference, links by class of pairs (`Links.factor`) x coverage and x the quality that is
        expected; NaN if unknown.
    outcome_values : (combinations, outcomes) float64
        NaN if unknown, or if it describes a model that did not succeed.
    pearson, spearman : (features, outcomes) float64
        NaN if fewer than `FEWEST_MODELS` combinations have both.
    numbers : (features, outcomes) int64
        Number of combinations behind each coefficient.
    """

    dataset: str
    combinations: tuple[str, ...]
    features: tuple[str, ...]
    outcomes: tuple[str, ...]
    feature_values: Array
    outcome_values: Array
    pearson: Array
    spearman: Array
    numbers: NDArray[np.int64]

    def __repr__(self) -> str:
        return (
            f"Relations on {self.dataset}: {len(self.features)} figures of pairs with "
            f"{len(self.outcomes)} of models, over {len(self.combinations)} combinations"
        )

    def _repr_html_(self) -> str:
        return as_html(repr(self), self.frame())

    def frame(self) -> pl.DataFrame:
        """One row per pair: ``feature, outcome, combinations, pearson, spearman``."""
        import polars as pl

        rows, columns = len(self.features), len(self.outcomes)
        return pl.DataFrame(
            {
                "feature": np.repeat(self.features, columns),
                "outcome": np.tile(self.outcomes, rows),
                "combinations": self.numbers.ravel(),
                "pearson": self.pearson.ravel(),
                "spearman": self.spearman.ravel(),
            },
            nan_to_null=True,
        )


def relate_outcomes(
    results: Measured | str | Path, preset: str | None = None, *, dataset: str | None = None
) -> Relations:
    """Correlate figures of image pairs with figures of reconstructions, over the combinations.

    Figures that describe a model (3D points, errors, distances) count for the combinations whose
    reconstruction succeeded; the number of registered images counts for all.

    Parameters
    ----------
    results : Results or path
        A results folder or packed results, with reconstructions.
    preset : str, optional
        A row of `settings.SCORE_PRESETS`: whether pairs that do not beat chance have failed.
    dataset : str, optional
        Needed if there are several.

    Returns
    -------
    Relations

    Raises
    ------
    ScoreError
        If fewer than `FEWEST_MODELS` combinations were both measured and reconstructed, or no
        figure varies over them.
    """
    import polars as pl

    measured = opened(results)
    rows = rows_of_dataset(measured.table(), dataset)
    if rows.is_empty():
        raise ScoreError("there are no measured rows; measure some with `aerocues.run`")
    chosen = score_preset_named(preset) if preset else suitable_preset(rows)
    models = measured.reconstructions().filter(pl.col("dataset") == rows["dataset"][0])
    return relations_of(rows, models, chance_fails=chosen.chance_fails)


def relations_of(rows: pl.DataFrame, models: pl.DataFrame, *, chance_fails: bool) -> Relations:
    """The same for rows and reconstructions of one dataset; see `relate_outcomes`."""
    name = combination_name()
    features = figures_of_pairs(rows.with_columns(name), chance_fails=chance_fails)
    joined = features.join(_outcomes(models.with_columns(name)), on=COMBINATION).sort(COMBINATION)
    if len(joined) < FEWEST_MODELS:
        raise ScoreError(
            f"{len(joined)} combinations were both measured and reconstructed, too few for "
            f"correlations of pairs and models; make {FEWEST_MODELS} or more with "
            "`aerocues.reconstruct`"
        )
    return _related(rows["dataset"][0], joined, features.columns[1:])


def _outcomes(models: pl.DataFrame) -> pl.DataFrame:
    """The outcomes of each combination; null if unknown."""
    return models.select(
        COMBINATION, *(_outcome(models, outcome).alias(outcome.name) for outcome in OUTCOMES)
    )


def _outcome(models: pl.DataFrame, outcome: Outcome) -> pl.Expr:
    import polars as pl

    if outcome.name not in models.columns:
        return pl.lit(None, pl.Float64)
    value = pl.col(outcome.name).cast(pl.Float64)
    if not outcome.of_model:
        lost = pl.col("status").is_in(WITHOUT_MODEL) & value.is_not_null().any()
        return pl.when(lost).then(value.fill_null(0)).otherwise(value)
    says = pl.col("status").is_in(SUCCESS)
    if outcome.to_reference and "reference" in models.columns:
        says &= pl.col("reference") != pl.col(COMBINATION)
    return pl.when(says).then(value)


def _related(dataset: str, joined: pl.DataFrame, features: Sequence[str]) -> Relations:
    varied = [_varying(joined, names) for names in (features, [each.name for each in OUTCOMES])]
    if not all(varied):
        raise _nothing_varies()
    first, second = (
        joined.select(names).to_numpy().astype(np.float64).reshape(len(joined), len(names))
        for names in varied
    )
    both = (~np.isnan(first)).T.astype(np.int64) @ (~np.isnan(second)).astype(np.int64)
    too_few = both < FEWEST_MODELS
    pearson, spearman = (
        np.where(too_few, np.nan, correlation_between(first.T, second.T, method))
        for method in ("pearson", "spearman")
    )
    if np.isnan(spearman).all():
        raise _nothing_varies()
    return Relations(
        dataset,
        tuple(joined[COMBINATION]),
        tuple(varied[0]),
        tuple(varied[1]),
        first,
        second,
        pearson,
        spearman,
        both,
    )


def _nothing_varies() -> ScoreError:
    return ScoreError(
        f"no figure varies over {FEWEST_MODELS} or more comparable models; reconstruct with more "
        "combinations"
    )


def _varying(table: pl.DataFrame, names: Sequence[str]) -> list[str]:
    """The columns that vary, with values for enough models."""

    def known(name: str) -> Iterator[float]:
        return (value for value in table[name].drop_nulls() if np.isfinite(value))

    return [
        name
        for name in names
        if len(list(known(name))) >= FEWEST_MODELS and len(set(known(name))) > 1
    ]
