"""The part of a results folder that is about 3D models: their figures and their clouds."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from aerocues.errors import StoreError
from aerocues.results.clouds import Cloud, read_cloud
from aerocues.results.folder_files import FolderFiles
from aerocues.results.reconstruction_schema import RECONSTRUCTION_IDENTITY, RECONSTRUCTIONS
from aerocues.results.reconstructions import reconstruction_table
from aerocues.results.schema import polars_schema
from aerocues.results.whole_files import parquet_content

if TYPE_CHECKING:
    import polars as pl

RECONSTRUCTED = "reconstructions.parquet"
CLOUDS = "clouds"


class ReconstructionStore(FolderFiles):
    """Figures of reconstructions, one row a dataset and combination, and a cloud for each."""

    def write_reconstructions(self, figures: pl.DataFrame) -> None:
        """Store the figures of 3D reconstructions; those that are there are replaced.

        Parameters
        ----------
        figures : pl.DataFrame
            Columns of `schema.RECONSTRUCTIONS`, one row a dataset and combination; a column that
            is missing is unknown in all rows.
        """
        self._write(self.folder / RECONSTRUCTED, parquet_content(reconstruction_table(figures)))

    def add_reconstructions(self, figures: pl.DataFrame) -> None:
        """Add figures of one dataset; those of other settings go, as they are not comparable.

        Clouds without a row go, too.

        Parameters
        ----------
        figures : pl.DataFrame
            Of one dataset and under one ``settings_key``.
        """
        import polars as pl

        new = reconstruction_table(figures)
        same = (pl.col("dataset") == new["dataset"][0]) & (
            (pl.col("settings_key") != new["settings_key"][0]) | pl.col("settings_key").is_null()
        )
        kept = self.reconstructions().filter(~same)
        kept = kept.join(new, on=RECONSTRUCTION_IDENTITY, how="anti")
        table = pl.concat([kept, new])
        self.write_reconstructions(table)
        for file in self.cloud_files():
            if file.stem not in set(table["row_key"]):
                file.unlink()

    def reconstructions(self) -> pl.DataFrame:
        """The figures of 3D reconstructions, by dataset and combination; often none."""
        import polars as pl

        schema = pl.Schema(polars_schema(RECONSTRUCTIONS))
        if not (self.folder / RECONSTRUCTED).is_file():
            return pl.DataFrame(schema=schema)
        file = self.folder / RECONSTRUCTED
        return self._collect(
            pl.scan_parquet(file, schema=schema, missing_columns="insert", extra_columns="ignore")
        )

    def write_cloud(self, row_key: str, cloud: Cloud) -> None:
        """Store the cloud of the reconstruction whose row has this key."""
        folder = self.folder / CLOUDS
        folder.mkdir(exist_ok=True)
        self._write(folder / f"{row_key}.npz", cloud.content())

    def cloud(self, row_key: str) -> Cloud | None:
        """The cloud of a reconstruction; None where there is none.

        Raises
        ------
        StoreError
            If its file is damaged or cannot be read.
        """
        file = self.folder / CLOUDS / f"{row_key}.npz"
        if not file.is_file():
            return None
        try:
            return read_cloud(file.read_bytes(), file)
        except OSError as error:
            raise StoreError(f"cannot read {file}: {error.strerror}; check its access") from error

    def cloud_files(self) -> list[Path]:
        """The files of all clouds."""
        return sorted((self.folder / CLOUDS).glob("*.npz"))
