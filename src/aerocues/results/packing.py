"""Packs a results folder into one file, to move it to another machine."""

from __future__ import annotations

import io
import re
import shutil
import tempfile
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

from aerocues.errors import StoreError
from aerocues.expansion import why_too_large
from aerocues.results.expanded_size import why_not_decoded
from aerocues.results.reconstruction_store import CLOUDS, RECONSTRUCTED
from aerocues.results.run_record import record_content
from aerocues.results.store import PARTS, PLAN, RUN, Store
from aerocues.results.whole_files import parquet_content
from aerocues.scratch_folders import remove_left_over, scratch_prefix

if TYPE_CHECKING:
    import polars as pl

SINGLE_PART = f"{PARTS}/all.parquet"
MEMBER = re.compile(
    rf"{re.escape(PLAN)}|{re.escape(RECONSTRUCTED)}|{RUN}|{PARTS}/[^/]+\.parquet|{CLOUDS}/[^/]+\.npz"
)
EARLIEST = (1980, 1, 1, 0, 0, 0)
# Errors of zipfile for damaged files; RuntimeError means encryption.
BROKEN = (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError)


def folder_content(
    facts: Mapping[str, Any],
    plan: pl.DataFrame,
    rows: pl.DataFrame,
    reconstructions: pl.DataFrame | None,
) -> dict[str, bytes]:
    """The files of a results folder with a single part, by name.

    ``run.json`` comes last, because a folder without it is not a results folder.
    """
    content = {SINGLE_PART: parquet_content(rows), PLAN: parquet_content(plan)}
    if reconstructions is not None:
        content[RECONSTRUCTED] = parquet_content(reconstructions)
    return {**content, RUN: record_content(facts)}


def packed(store: Store) -> bytes:
    """A results folder with all its content as a zip file; see `zipped`.

    Raises
    ------
    StoreError
        If the folder cannot be read.
    """
    figures = store.reconstructions()
    found = figures if len(figures) else None
    content = folder_content(store.run(), store.plan(), store.rows(), found)
    for cloud in store.cloud_files():
        content[f"{CLOUDS}/{cloud.name}"] = cloud.read_bytes()
    return zipped(content)


def zipped(content: Mapping[str, bytes]) -> bytes:
    """Files by name as a zip file; equal content gives equal files."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in content.items():
            member = zipfile.ZipInfo(name, EARLIEST)
            member.compress_type = zipfile.ZIP_DEFLATED
            member.external_attr = 0o644 << 16
            archive.writestr(member, data)
    return file.getvalue()


def unpack(file: Path) -> Path:
    """Unpack a results folder into a new temporary folder, which the caller must remove.

    Parameters
    ----------
    file : path
        A file from `packed`, or a zip file of a results folder made by hand.

    Raises
    ------
    StoreError
        If it is not such a file, is damaged, has a member outside of the folder, or the disk is
        full.
    """
    remove_left_over()
    folder = Path(tempfile.mkdtemp(prefix=scratch_prefix("packed")))
    try:
        _extract(file, folder)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    return folder


def _extract(file: Path, folder: Path) -> None:
    try:
        with zipfile.ZipFile(file) as archive:
            members = _members(file, archive)
            # No member gives more than the size that it states: zipfile stops there.
            expanded = sum(member.file_size for member in members.values())
            _refuse(file, "", why_too_large(file.stat().st_size, expanded))
            for name, member in members.items():
                target = folder / name
                target.parent.mkdir(exist_ok=True)
                with archive.open(member) as content, target.open("wb") as copy:
                    shutil.copyfileobj(content, copy)
                if target.suffix == ".parquet":
                    _refuse(file, f"in {name} ", why_not_decoded(target.read_bytes()))
    except BROKEN as error:
        raise StoreError(
            f"{file} is neither a results folder nor packed results ({error}); give a results "
            "folder, pack it again, or read a table with `aerocues.import_results`"
        ) from error
    except OSError as error:
        raise StoreError(
            f"cannot unpack {file}: {error.strerror or error}; free space or grant access, or "
            "unzip it "
            "and name the folder"
        ) from error


def _refuse(file: Path, where: str, why: str | None) -> None:
    if why is not None:
        raise StoreError(f"{file} is not read: {where}{why}; ask for the results once more")


def _members(file: Path, archive: zipfile.ZipFile) -> dict[str, zipfile.ZipInfo]:
    """The files of the results folder in an archive, by name; other files are ignored."""
    paths = {PurePosixPath(member.filename): member for member in archive.infolist()}
    for path in paths:
        if path.is_absolute() or ".." in path.parts:
            raise StoreError(f"{file} would write to {path}, outside; do not use it")
    # Archives made by hand often contain the folder itself.
    tops = [path.parent for path in paths if path.name == RUN and len(path.parts) <= 2]
    if len(tops) != 1:
        what = f"several files {RUN}" if tops else f"no {RUN}"
        raise StoreError(f"{file} is not a packed results folder ({what}); pack it again")
    inner = {
        str(path.relative_to(tops[0])): member
        for path, member in paths.items()
        if path.is_relative_to(tops[0])
    }
    if PLAN not in inner:
        raise StoreError(f"{file} is not a packed results folder (no {PLAN}); pack it again")
    return {name: member for name, member in inner.items() if MEMBER.fullmatch(name)}
