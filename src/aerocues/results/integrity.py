"""Whether files of a results folder are as they were written; damage costs its own rows only."""

from __future__ import annotations

import contextlib
import io
import os
import sys
import warnings
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from io import FileIO
from pathlib import Path
from typing import Any

from aerocues.errors import DamageWarning, StoreError
from aerocues.results.checksums import agrees_with_checksum
from aerocues.results.expanded_size import why_not_decoded
from aerocues.standard_error import standard_error_in

THREADS = 4
LONGEST_REASON = 120


@dataclass(frozen=True)
class Checked:
    """A file that was looked at.

    Parameters
    ----------
    file : Path
    problem : str or None
        What is wrong with it.
    has_checksum : bool
        Older files have none: a changed value in them cannot be seen.
    """

    file: Path
    problem: str | None = None
    has_checksum: bool = True

    def __str__(self) -> str:
        return f"{self.file} is damaged ({self.problem})"


def warn_of(damaged: Iterable[Checked], consequence: str) -> None:
    """Tell of damaged files, and what follows from that."""
    for checked in damaged:
        warnings.warn(f"{checked}: {consequence}", DamageWarning, stacklevel=3)


def check_tables(
    files: Iterable[Path], schema: Mapping[str, Any] | None = None, *, decode: bool = False
) -> list[Checked]:
    """Check Parquet files in the order given.

    Parameters
    ----------
    files : iterable of Path
        One that does not exist any more is sound: another process has put it together with others.
    schema : mapping of str to polars type, optional
        Types that columns must have where they exist.
    decode : bool
        Also decode those without a checksum.

    Raises
    ------
    StoreError
        If a file may not be read.
    """

    def check(file: Path) -> Checked:
        return check_table(file, schema, decode=decode)

    with ThreadPoolExecutor(THREADS) as threads:  # reading and checksums let others work
        return list(threads.map(check, files))


def check_table(
    file: Path, schema: Mapping[str, Any] | None = None, *, decode: bool = False
) -> Checked:
    """Check one Parquet file; see `check_tables`."""
    try:
        with file.open("rb", buffering=0) as stream:
            agrees = agrees_with_checksum(stream)
            problem = None if agrees else _why_unsound(stream, agrees, schema, decode=decode)
    except FileNotFoundError:
        return Checked(file)
    except PermissionError as error:
        raise StoreError(
            f"cannot read {file}: {error.strerror}; grant access to it and run the same command "
            "again"
        ) from error
    except OSError as error:
        return Checked(file, f"it cannot be read: {error.strerror or error}")
    return Checked(file, problem, has_checksum=agrees is not None)


def _why_unsound(
    stream: FileIO, agrees: bool | None, schema: Mapping[str, Any] | None, *, decode: bool
) -> str | None:
    """What is wrong with a file that does not agree with its checksum, or has none."""
    if agrees is False:
        return "its content does not agree with its checksum"
    if not stream.seek(0, 2):
        return "it is empty"
    stream.seek(0)
    return why_undecodable(stream.read(), schema) if decode else None


def why_undecodable(content: bytes, schema: Mapping[str, Any] | None = None) -> str | None:
    """Why Parquet cannot be decoded, or None; see `check_tables` for the schema."""
    import polars as pl

    if problem := why_not_decoded(content):
        return problem
    how: dict[str, Any] = {}
    if schema is not None:
        how = {"schema": schema, "missing_columns": "insert", "extra_columns": "ignore"}
    try:
        with without_words_of_libraries():
            pl.scan_parquet(io.BytesIO(content), **how).collect()
    except (pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError) as error:
        return f"it cannot be decoded: {reason_of(error)}"
    return None


@contextlib.contextmanager
def without_words_of_libraries() -> Iterator[None]:
    """Keep what polars prints when it panics on a damaged file from standard error."""
    if sys.stderr is not None:
        sys.stderr.flush()
    with Path(os.devnull).open("wb") as nowhere, standard_error_in(nowhere):
        yield


def reason_of(error: BaseException) -> str:
    """The message of polars in one short line."""
    return " ".join(str(error).split())[:LONGEST_REASON]
