"""Makes results folders from measurement tables of other programs."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aerocues.errors import StoreError
from aerocues.results.combination_columns import combination_name
from aerocues.results.foreign_rows import IMPORTED, OTHER_NAMES, completed_rows
from aerocues.results.hashing import content_hash
from aerocues.results.measured_results import Results
from aerocues.results.packing import folder_content
from aerocues.results.plan_table import IDENTITY_NAMES
from aerocues.results.reconstructions import read_reconstructions
from aerocues.results.store import RUN, Store, others_in
from aerocues.results.table_files import TableFile, read_table_file
from aerocues.results.whole_files import write_whole

if TYPE_CHECKING:
    import polars as pl

# Characters that a folder name may have on any system.
ODD = re.compile(r"[^\w.+]+")
LONGEST_NAME = 80


@dataclass(frozen=True)
class _Import:
    """The rows of one dataset on one platform, and their folder."""

    dataset: str
    platform: str | None
    rows: pl.DataFrame
    folder: Path

    @property
    def title(self) -> str:
        return f"{self.dataset} on {self.platform}" if self.platform else self.dataset


@dataclass(frozen=True)
class _Figures:
    """Reconstructions from a file."""

    table: TableFile
    rows: pl.DataFrame

    def check(self, datasets: Iterable[str]) -> None:
        """StoreError if it has no reconstructions of any of the datasets."""
        wanted = list(dict.fromkeys(datasets))
        if not self.rows["dataset"].is_in(wanted).any():
            there = ", ".join(self.rows["dataset"].unique().sort())
            raise self.table.wrong(
                f"has reconstructions of {there} only, not of {', '.join(wanted)}; give the file "
                "of these "
                "datasets or rename them"
            )

    def of(self, dataset: str) -> pl.DataFrame | None:
        """The reconstructions of one dataset; None if there are none."""
        import polars as pl

        found = self.rows.filter(pl.col("dataset") == dataset)
        return found if len(found) else None


def import_results(
    file: str | Path,
    output: str | Path,
    *,
    reconstruction: str | Path | None = None,
    dataset: str | None = None,
    platform: str | None = None,
) -> list[Results]:
    """Make results folders from a table of measurements.

    Parameters
    ----------
    file : path
        CSV or Parquet, one row per combination and pair. Columns ``dataset, detector, descriptor,
        norm, matcher, pair, precision, recall, repeatability, f1_score, inliers, matches,
        seconds_per_1k_matches, seconds_per_1k_inliers``; optionally ``platform`` (or ``machine``)
        and any other column of `schema.COLUMNS`.
    output : path
        The results folder. If the table has several datasets or platforms: a folder with one
        results folder for each, named DATASET-PLATFORM. The same import can be repeated.
    reconstruction : path, optional
        Table of reconstructions; see `reconstructions.read_reconstructions`.
    dataset, platform : str, optional
        Import only these.

    Returns
    -------
    list of Results
        One for each dataset and platform, in the order of the table.

    Raises
    ------
    StoreError
        If a file cannot be read or is invalid, or the output folder has other content. In this case
        nothing is written.
    """
    table = read_table_file(Path(file), OTHER_NAMES)
    rows = completed_rows(table)
    rows = _chosen(table, rows, "dataset", dataset)
    rows = _chosen(table, rows, "platform", platform)
    imports = _divided(rows, Path(output))
    _check_places(Path(output), imports)
    figures = None
    if reconstruction is not None:
        figures = _Figures(*read_reconstructions(Path(reconstruction)))
        figures.check(one.dataset for one in imports)
    _write({one.folder: _content(one, table, figures) for one in imports})
    return [Results(one.folder) for one in imports]


def _chosen(table: TableFile, rows: pl.DataFrame, what: str, name: str | None) -> pl.DataFrame:
    """The rows of a dataset or platform; all rows if no name is given."""
    import polars as pl

    if name is None:
        return rows
    column = OTHER_NAMES.get(what, what)
    chosen = rows.filter(pl.col(column) == name)
    if chosen.is_empty():
        there = ", ".join(rows[column].drop_nulls().unique(maintain_order=True)) or "none"
        raise table.wrong(f"has no {what} {name!r}; choose from: {there}")
    return chosen


def _divided(rows: pl.DataFrame, output: Path) -> list[_Import]:
    parts = rows.partition_by("dataset", "machine", maintain_order=True, as_dict=True)
    if len(parts) == 1:
        [((dataset, platform), only)] = parts.items()
        return [_Import(dataset, platform, only, output)]
    taken: list[str] = []
    for dataset, platform in parts:
        taken.append(_folder_name(f"{dataset}-{platform}" if platform else dataset, taken))
    return [
        _Import(dataset, platform, part, output / name)
        for name, ((dataset, platform), part) in zip(taken, parts.items(), strict=True)
    ]


def _folder_name(title: str, taken: Sequence[str]) -> str:
    """A folder name that is valid on any file system and unique regardless of case."""
    name = ODD.sub("-", title)[:LONGEST_NAME].strip("-. ") or "unnamed"
    names = chain([name], (f"{name}-{number}" for number in count(2)))
    used = {other.casefold() for other in taken}
    return next(name for name in names if name.casefold() not in used)


def _check_places(output: Path, imports: Sequence[_Import]) -> None:
    """Raise StoreError if a folder has other content."""
    if len(imports) > 1 and output.is_dir():
        if (output / RUN).is_file():
            raise StoreError(
                f"{output} is a results folder itself, and there are {len(imports)} datasets and "
                "platforms; choose another `output`, or one of them by `dataset` and `platform`"
            )
        other = next(output.iterdir(), None)
        if other and not any(output.glob(f"*/{RUN}")):
            raise StoreError(
                f"{output} holds other files ({other.name}, ...); give a new or empty folder as "
                "`output`"
            )
    for one in imports:
        _check_place(one)


def _check_place(one: _Import) -> None:
    folder, another = one.folder, "give another folder as `output`"
    if not folder.is_dir():
        return  # a file is refused when the folder is created
    others = others_in(folder)
    if others:
        raise StoreError(f"{folder} holds other files ({others[0]}, ...); {another}")
    if not (folder / RUN).is_file():
        if Store(folder).parts():
            raise StoreError(f"{folder} holds measured rows; {another}")
        return
    earlier = Store.open(folder).run().get(IMPORTED)
    if not earlier:
        raise StoreError(f"{folder} holds what a run measured; {another}")
    there = (earlier.get("dataset"), earlier.get("platform"))
    if there != (one.dataset, one.platform):
        told = " on ".join(filter(None, there))
        raise StoreError(f"{folder} holds another import ({told}); {another} for {one.title}")


def _keyed(rows: pl.DataFrame, key: str) -> pl.DataFrame:
    """The rows with their own keys if every row has one (as from results), else new keys."""
    import polars as pl

    keys, settings = rows["row_key"], rows["settings_key"]
    known = not keys.null_count() and not settings.null_count()
    if known and keys.n_unique() == len(rows) and settings.n_unique() == 1:
        return rows
    named = [pl.col(name).cast(pl.String).fill_null("") for name in IDENTITY_NAMES]
    return rows.with_columns(
        pl.concat_str(pl.lit(key), *named, separator="/").alias("row_key"),
        pl.lit(key).alias("settings_key"),
    )


def _content(one: _Import, table: TableFile, figures: _Figures | None) -> dict[str, bytes]:
    """The files of a results folder. Existing reconstructions are kept if no new ones are given."""
    import polars as pl

    key = content_hash([IMPORTED, one.dataset, one.platform])
    rows = _keyed(one.rows, key)
    plan = rows.select(*IDENTITY_NAMES, "row_key", "settings_key", pl.lit(key).alias("dataset_key"))
    reconstructions = figures.of(one.dataset) if figures else None
    origin = _origin(table) | {"dataset": one.dataset, "platform": one.platform}
    if figures and reconstructions is not None:
        origin["reconstruction"] = _origin(figures.table)
    facts = _facts(one, rows) | {"settings_key": rows["settings_key"][0], IMPORTED: origin}
    return folder_content(facts, plan, rows, reconstructions)


def _origin(table: TableFile) -> dict[str, Any]:
    return {"file": table.name, "sha256": table.sha256}


def _facts(one: _Import, rows: pl.DataFrame) -> dict[str, Any]:

    combinations = rows.select(combination_name()).to_series()
    opencv = rows["opencv_version"].drop_nulls().unique().sort()
    return {
        "dataset": {
            "name": one.dataset,
            "geometry": None,
            "images": None,
            "pairs": rows.select("image_1", "image_2").n_unique(),
            "settings": {},
        },
        "preset": IMPORTED,
        "protocol": None,
        "combinations": combinations.unique(maintain_order=True).to_list(),
        "exclusions": [],
        "versions": {"opencv": ", ".join(opencv)} if len(opencv) else {},
        "machine": {"name": one.platform},
    }


def _write(contents: Mapping[Path, Mapping[str, bytes]]) -> None:
    """Write all folders or none of them."""
    with ExitStack() as undo, ExitStack() as locks:
        for folder in contents:
            made = _outermost_missing(folder)
            if made:
                undo.callback(shutil.rmtree, made, ignore_errors=True)
            locks.enter_context(Store.create(folder).writing())
        files = {
            folder / name: data
            for folder, content in contents.items()
            for name, data in content.items()
        }
        try:
            write_whole(files)
        except OSError as error:
            raise StoreError(
                f"cannot write to {error.filename or next(iter(contents))}: "
                f"{error.strerror or error}; nothing was imported: free space or grant access and "
                "import "
                "again"
            ) from error
        undo.pop_all()


def _outermost_missing(folder: Path) -> Path | None:
    """The folder whose removal would undo the creation of `folder`."""
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    return missing[-1] if missing else None
