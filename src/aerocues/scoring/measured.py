"""Measured results as a table that can be scored."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, TypeVar

from aerocues.errors import ArgumentError, ScoreError
from aerocues.results.combination_columns import METHODS, combination_name
from aerocues.results.statuses import RETRIED
from aerocues.scoring.combinations import (
    SUCCESS,
    decision_table,
    has_chance_test,
    suitable_preset,
)
from aerocues.scoring.criteria import Criterion, criteria_named
from aerocues.scoring.settings import (
    Names,
    ScorePreset,
    ScoreSettings,
    names_of,
    score_preset_named,
)
from aerocues.scoring.table import DecisionTable

if TYPE_CHECKING:
    import polars as pl

    from aerocues.results.measured_results import Results

# If fewer are reconstructed, they are a selection by the user, and the others keep their score.
ENOUGH_RECONSTRUCTED = 0.5


class Measured(Protocol):
    """Results that can be scored."""

    def table(self) -> pl.DataFrame:
        """Rows of image pairs."""
        ...

    def reconstructions(self) -> pl.DataFrame:
        """Rows of reconstructions; may be empty."""
        ...


Given = TypeVar("Given", bound=Measured)


def opened(results: Given | str | Path) -> Given | Results:
    """Results as they are, or those of a folder or packed file.

    Raises
    ------
    ArgumentError
        If they are neither.
    StoreError
        If there are no results at that place.
    """
    if isinstance(results, str | Path):
        from aerocues.results.measured_results import Results

        return Results(results)
    if not hasattr(results, "table"):
        raise ArgumentError(
            f"`results` must be Results or the path of a results folder, got {results!r}"
        )
    return results


def refuse_repeated(results: Iterable[Measured]) -> None:
    """Raise ScoreError if the same folder, packed file or object is given twice."""
    places: list[object] = []
    for each in results:
        folder = getattr(each, "folder", None)
        place = id(each) if folder is None else folder.resolve()
        if place in places:
            named = "the same result" if folder is None else place
            raise ScoreError(f"{named} is given twice; give each result once")
        places.append(place)


@dataclass(frozen=True)
class MeasuredRows:
    """Rows in memory, with their reconstructions."""

    rows: pl.DataFrame
    models: pl.DataFrame

    def table(self) -> pl.DataFrame:
        return self.rows

    def reconstructions(self) -> pl.DataFrame:
        return self.models


@dataclass(frozen=True)
class MeasuredTable:
    """The measurements of one dataset, ready to be scored.

    Attributes
    ----------
    dataset : str
    table : DecisionTable
    preset : ScorePreset
        Preset that the criteria come from.
    seconds : mapping of str to float
        Median time of each combination for an image and a pair, if known.
    machines : tuple of str
        Kinds of machine that measured, if known.
    """

    dataset: str
    table: DecisionTable
    preset: ScorePreset
    seconds: Mapping[str, float]
    machines: tuple[str, ...] = ()


def rows_of_dataset(rows: pl.DataFrame, dataset: str | None) -> pl.DataFrame:
    """The rows of one dataset.

    Raises
    ------
    ScoreError
        If there is no such dataset, or there are several and none is named.
    """
    import polars as pl

    datasets = rows["dataset"].unique().sort().to_list()
    if dataset is None and len(datasets) > 1:
        raise ScoreError(
            f"there are several datasets; choose one as `dataset`: {', '.join(datasets)}"
        )
    if dataset is not None and dataset not in datasets:
        raise ScoreError(f"there is no dataset {dataset!r}; choose from {', '.join(datasets)}")
    return rows if dataset is None else rows.filter(pl.col("dataset") == dataset)


def settings_from(preset: ScorePreset, **changes: object) -> ScoreSettings:
    """Settings of a preset, replaced by the changes that are not None."""
    given = {name: value for name, value in changes.items() if value is not None}
    if "weights" in given:
        given["weights"] = names_of(given["weights"])  # type: ignore[arg-type]
    return replace(preset.settings, **given)  # type: ignore[arg-type]


def table_of(
    results: Measured,
    preset: str | None = None,
    *,
    criteria: Names | None = None,
    dataset: str | None = None,
    reconstruction: bool | None = None,
) -> MeasuredTable:
    """Arrange the measurements of one dataset for scoring.

    Parameters
    ----------
    results : Measured
        Such as `aerocues.Results`.
    preset : str, optional
        A row of `settings.SCORE_PRESETS`; the one that suits the measurements by default.
    criteria : sequence of str, optional
        A row of `settings.PRESETS`; the one that suits the measurements by default.
    criteria : str or sequence of str, optional
        In place of the preset's.
    dataset : str, optional
        Needed if there are several.
    reconstruction : bool, optional
        Whether to add the preset's criteria of reconstruction; by default if most combinations
        were reconstructed.

    Raises
    ------
    ScoreError
        If something does not exist or was not measured.
    """
    import polars as pl

    rows = rows_of_dataset(results.table(), dataset)
    if rows.is_empty():
        raise ScoreError("there are no measured rows; measure some with `aerocues.run`")
    chosen = score_preset_named(preset) if preset else suitable_preset(rows)
    _refuse_failure(rows, chosen)
    models = results.reconstructions().filter(pl.col("dataset") == rows["dataset"][0])
    names = chosen.criteria if criteria is None else names_of(criteria)
    if reconstruction is None:
        reconstruction = criteria is None and _enough_models(rows, models)
    if reconstruction:
        names = (*names, *(name for name in chosen.reconstruction_criteria if name not in names))
    listed = criteria_named(names)
    if not has_chance_test(rows):
        _refuse_chance(listed)
    table = decision_table(
        rows,
        listed,
        reconstructions=models,
        chance_fails=chosen.chance_fails,
        links=chosen.links and criteria is None,
    )
    machines = tuple(rows["machine"].drop_nulls().unique().sort())
    return MeasuredTable(rows["dataset"][0], table, chosen, _median_seconds(rows), machines)


def _refuse_failure(rows: pl.DataFrame, preset: ScorePreset) -> None:
    """Raise a clear error if nothing succeeded, before scoring fails for lack of values."""
    statuses = dict(rows["status"].value_counts(sort=True, name="rows").iter_rows())
    if "ok" in statuses or ("chance" in statuses and not preset.chance_fails):
        return
    told = ", ".join(f"{status} {number:,}" for status, number in statuses.items())
    if set(statuses) <= set(RETRIED):
        reason = rows["message"].drop_nulls().to_list()[:1]
        raise ScoreError(
            f"nothing could be measured on {rows['dataset'][0]} ({told}): {''.join(reason)}"
        )
    raise ScoreError(
        f"nothing succeeded on {rows['dataset'][0]} ({told}), so there is nothing to rank; "
        "its messages tell why: try larger images (`max_width`), other pairs or combinations"
    )


def _enough_models(rows: pl.DataFrame, models: pl.DataFrame) -> bool:
    """Whether most combinations were reconstructed, and at least one successfully.

    If all models failed, they do not distinguish the combinations.
    """
    measured = rows.select(METHODS).unique()
    share = measured.join(models, on=METHODS, how="semi").height / measured.height
    return share >= ENOUGH_RECONSTRUCTED and bool(models["status"].is_in(SUCCESS).any())


def _median_seconds(rows: pl.DataFrame) -> dict[str, float]:
    import polars as pl

    name = combination_name()
    medians = rows.group_by(name).agg(pl.col("total_seconds").median()).drop_nulls()
    return dict(medians.iter_rows())


def _refuse_chance(criteria: Sequence[Criterion]) -> None:
    needed = [each.name for each in criteria if each.beyond_chance]
    if needed:
        raise ScoreError(
            f"no row has inliers beyond chance, which {needed[0]} needs; score with "
            '`preset="thesis"`, or measure again with `aerocues.run` and `preset="default"`'
        )
