"""The part of a results folder with 3D models: their table and their clouds."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from aerocues.errors import StoreError
from aerocues.results.clouds import Cloud, read_cloud
from aerocues.results.folder_files import FolderFiles, own_files
from aerocues.results.integrity import Checked, check_tables, warn_of
from aerocues.results.reconstruction_schema import RECONSTRUCTION_IDENTITY, RECONSTRUCTIONS
from aerocues.results.reconstructions import reconstruction_table
from aerocues.results.schema import polars_schema
from aerocues.results.whole_files import parquet_content

if TYPE_CHECKING:
    import polars as pl

RECONSTRUCTED = "reconstructions.parquet"
CLOUDS = "clouds"


class ReconstructionStore(FolderFiles):
    """Table of reconstructions, one row per dataset and combination, with a cloud for each."""

    def write_reconstructions(self, figures: pl.DataFrame) -> None:
        """Store the table of 3D reconstructions; an existing table is replaced.

        Parameters
        ----------
        figures : pl.DataFrame
            Columns of `schema.RECONSTRUCTIONS`, one row per dataset and combination. A missing
            column is unknown in all rows.
        """
        self._write(self.folder / RECONSTRUCTED, parquet_content(reconstruction_table(figures)))

    def add_reconstructions(self, figures: pl.DataFrame) -> None:
        """Add rows of one dataset; its rows under other settings are removed (not comparable).

        Clouds without a row are removed, too.

        Parameters
        ----------
        figures : pl.DataFrame
            Rows of one dataset under one ``settings_key``.
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
        """The table of 3D reconstructions, sorted by dataset and combination; often empty.

        A damaged table is told and left out.
        """
        import polars as pl

        schema = pl.Schema(polars_schema(RECONSTRUCTIONS))
        file = self.folder / RECONSTRUCTED
        files = [file] if file.is_file() else []
        damaged = [each for each in check_tables(files, schema, decode=True) if each.problem]
        warn_of(damaged, "its models are left out; make them again with `aerocues.reconstruct`")
        if damaged or not files:
            return pl.DataFrame(schema=schema)
        return self._collect(
            pl.scan_parquet(file, schema=schema, missing_columns="insert", extra_columns="ignore")
        )

    def write_cloud(self, row_key: str, cloud: Cloud) -> None:
        """Store the cloud of the reconstruction with this row key."""
        folder = self.folder / CLOUDS
        folder.mkdir(exist_ok=True)
        self._write(folder / f"{row_key}.npz", cloud.content())

    def cloud(self, row_key: str) -> Cloud | None:
        """The cloud of a reconstruction; None if it has no cloud.

        Raises
        ------
        StoreError
            If its file is damaged or may not be read.
        """
        file = self.folder / CLOUDS / f"{row_key}.npz"
        if not file.is_file():
            return None
        found = _read(file)
        if isinstance(found, Cloud):
            return found
        raise StoreError(f"{found}; remove it and make it again with `aerocues.reconstruct`")

    def cloud_files(self) -> list[Path]:
        """The files of all clouds."""
        return own_files(self.folder / CLOUDS, ".npz")

    def check_clouds(self) -> Iterator[Checked]:
        """The files of all clouds, checked; each array in them has a checksum."""
        for file in self.cloud_files():
            found = _read(file)
            yield Checked(file) if isinstance(found, Cloud) else found


def _read(file: Path) -> Cloud | Checked:
    """The cloud in a file, or what is wrong with it."""
    try:
        return read_cloud(file.read_bytes(), file)
    except PermissionError as error:
        raise StoreError(f"cannot read {file}: {error.strerror}; grant access to it") from error
    except OSError as error:
        return Checked(file, f"it cannot be read: {error.strerror or error}")
    except StoreError as error:
        return Checked(file, str(error.__cause__))
