"""A folder of models: one subfolder per combination, and the settings."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aerocues.errors import StoreError
from aerocues.methods.combination import Combination
from aerocues.notebooks import as_html
from aerocues.phrases import count
from aerocues.reconstruction.exports import MODEL
from aerocues.reconstruction.judging import CLOUD, PICTURE
from aerocues.reconstruction.one_model import OUTCOME
from aerocues.reconstruction.prepared import LIST
from aerocues.reconstruction.scene import FEATURES, IMAGES
from aerocues.results.clouds import Cloud, read_cloud
from aerocues.results.combination_columns import combination_name
from aerocues.results.metrics import Row
from aerocues.results.reconstruction_schema import RECONSTRUCTION_STATUSES
from aerocues.results.reconstructions import reconstruction_table
from aerocues.results.whole_files import json_content, parquet_content, write_whole

if TYPE_CHECKING:
    import polars as pl

SETTINGS = "reconstruction.json"
TABLE, TABLE_TEXT = "reconstructions.parquet", "reconstructions.csv"
SHOWN = (
    *("status", "registered_images", "images", "points_3d", "mean_track_length"),
    *("reprojection_error", "position_rmse", "reconstruction_seconds"),
)
RETRIED = tuple(status.name for status in RECONSTRUCTION_STATUSES if status.retried)


class Models:
    """The models of a scene in a folder.

    Parameters
    ----------
    folder : path
        Folder made by `aerocues.reconstruct`.

    Raises
    ------
    StoreError
        If it is not a folder of models.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        if not (self.folder / SETTINGS).is_file():
            raise StoreError(
                f"{self.folder} is not a folder of models (it has no {SETTINGS}); make one with "
                "`aerocues.reconstruct`"
            )

    def __repr__(self) -> str:
        table = self.table()
        counts = table["status"].value_counts(sort=True).iter_rows()
        statuses = ", ".join(f"{status} {number:,}" for status, number in counts)
        datasets = ", ".join(table["dataset"].unique().sort())
        made = f"{count(len(table), 'combination')} on {datasets}: {statuses}"
        return f"Models {self.folder}: {made if len(table) else 'none yet'}"

    def _repr_html_(self) -> str:
        table = self.table().select(combination_name(), *SHOWN)
        return as_html(repr(self), table.sort("points_3d", descending=True, nulls_last=True))

    @classmethod
    def create(cls, folder: Path) -> None:
        """Create the folder if it does not exist.

        Raises
        ------
        StoreError
            If it cannot be created, is a file, or has other content.
        """
        if folder.exists() and not folder.is_dir():
            raise StoreError(f"{folder} is a file; give the name of a folder as `output`")
        if folder.is_dir() and not (folder / SETTINGS).exists():
            own = (IMAGES, FEATURES, LIST)
            others = [p.name for p in folder.iterdir() if p.name not in own and p.name[0] != "."]
            if others:
                raise StoreError(
                    f"{folder} holds other files ({others[0]}, ...); give a new or empty folder as "
                    "`output`"
                )
        try:
            (folder / IMAGES).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise StoreError(
                f"cannot write to {folder}: {error.strerror}; choose another `output`"
            ) from error

    @property
    def settings(self) -> dict[str, Any]:
        """Settings that all models share, versions and machine."""
        found: dict[str, Any] = json.loads((self.folder / SETTINGS).read_text(encoding="utf-8"))
        return found

    def path(self, combination: Combination | str) -> Path:
        """The folder of the model of a combination."""
        return self.folder / str(combination).upper()

    def picture(self, combination: Combination | str) -> Path:
        """The picture of the cloud of a combination."""
        return self.path(combination) / PICTURE

    def cloud(self, combination: Combination | str) -> Cloud | None:
        """The cloud of the model of a combination; None if there is no model."""
        file = self.path(combination) / CLOUD
        return read_cloud(file.read_bytes(), file) if file.is_file() else None

    def table(self) -> pl.DataFrame:
        """One row per combination; columns as in `reconstruction_schema.RECONSTRUCTIONS`."""
        import polars as pl

        if not (self.folder / TABLE).is_file():
            return reconstruction_table(pl.DataFrame())
        return pl.read_parquet(self.folder / TABLE)


def read_outcome(folder: Path) -> Row | None:
    """The row of a finished reconstruction; None if it is not finished."""
    try:
        found = json.loads((folder / OUTCOME).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) else None


def has_files(place: Path) -> bool:
    """Whether the model and the cloud of a reconstruction exist and the cloud is readable."""
    try:
        read_cloud((place / CLOUD).read_bytes(), place / CLOUD)
    except (OSError, StoreError):
        return False
    return (place / MODEL / "0").is_dir()


def write_outcome(folder: Path, row: Row) -> None:
    """Mark a reconstruction as finished; call it after all files are written."""
    folder.mkdir(parents=True, exist_ok=True)
    write_whole({folder / OUTCOME: json_content(row)})


def write_table(folder: Path, rows: Iterable[Row]) -> pl.DataFrame:
    """Write the rows of all models as Parquet and CSV."""
    import polars as pl

    table = reconstruction_table(pl.DataFrame(list(rows), infer_schema_length=None, orient="row"))
    text = table.write_csv().encode()
    write_whole({folder / TABLE: parquet_content(table), folder / TABLE_TEXT: text})
    return table
