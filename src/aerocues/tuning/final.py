"""The final of a recommendation: models of the leaders of a race, and COLMAP's default."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aerocues.methods.combination import Combination
from aerocues.results.combination_columns import name_in_row
from aerocues.results.model_quality import model_quality
from aerocues.results.reconstruction_schema import BASELINE
from aerocues.scoring.objectives import Objective

if TYPE_CHECKING:
    import polars as pl

    from aerocues.results.metrics import Row

Order = tuple[bool, int, float, str]


@dataclass(frozen=True, eq=False)
class Final:
    """Models of the leaders, the best first.

    Parameters
    ----------
    rows : tuple of mapping
        Rows of the table of reconstructions, the best first.
    asked : tuple of Combination
        All that were to be built after COLMAP's default, in this order; those without a row were
        not finished in time.
    images, of : int
        How many images were reconstructed, and how many the flight has.
    folder : Path
        Of the models.
    objective : Objective
    """

    rows: tuple[Row, ...]
    asked: tuple[Combination, ...]
    images: int
    of: int
    folder: Path
    objective: Objective

    @classmethod
    def of_models(
        cls,
        table: pl.DataFrame,
        asked: tuple[Combination, ...],
        images: tuple[int, int],
        folder: Path,
        objective: Objective,
    ) -> Final:
        """The final in which these models were built, in order of their value."""
        wanted = {str(BASELINE), *map(str, asked)}
        rows = [row for row in table.iter_rows(named=True) if name_in_row(row) in wanted]
        rows.sort(key=lambda row: final_order(row, objective))
        return cls(tuple(rows), asked, *images, folder, objective)

    @property
    def best(self) -> Row | None:
        """The row of the best model; None where no combination was finished, or no model built."""
        finished = any(name_in_row(row) != str(BASELINE) for row in self.rows)
        built = [row for row in self.rows if row["registered_images"]]
        return built[0] if built and finished else None

    @property
    def baseline(self) -> Row | None:
        """The row of COLMAP's default, if it was finished."""
        return next((row for row in self.rows if name_in_row(row) == str(BASELINE)), None)

    @property
    def best_combination(self) -> Row | None:
        """The row of the best model that is not COLMAP's default."""
        built = [row for row in self.rows if row["registered_images"]]
        return next((row for row in built if name_in_row(row) != str(BASELINE)), None)

    @property
    def order(self) -> tuple[str, ...]:
        """All in the order in which they were to be built: COLMAP's default, then by rank."""
        return (str(BASELINE), *map(str, self.asked))

    @property
    def unfinished(self) -> tuple[str, ...]:
        """Those that there was no time for."""
        names = {name_in_row(row) for row in self.rows}
        return tuple(name for name in self.order if name not in names)


def final_order(row: Mapping[str, Any], objective: Objective) -> Order:
    """Sorts models, the best first: by success, images in place, then value.

    What loses images is never better than what holds them, whatever its points are worth.
    """
    return (
        row["status"] != "ok",
        -images_in_place(row),
        -model_value(row, objective),
        name_in_row(row),
    )


def images_in_place(row: Mapping[str, Any]) -> int:
    """Images whose cameras are in place; those of the model where no places are known."""
    placed = row["placed_images"]
    return int((row["registered_images"] if placed is None else placed) or 0)


def model_value(row: Mapping[str, Any], objective: Objective) -> float:
    """The quality of a model, divided by its time to the power of the objective."""
    seconds = row["reconstruction_seconds"]
    quality = model_quality(row) or 0.0
    return quality / seconds**objective.time_power if seconds else quality
