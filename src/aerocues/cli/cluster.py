"""Options of a Dask cluster, and what is said about its machines."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import polars as pl

    from aerocues.evaluation.dask_engine import DaskEngine


@contextlib.contextmanager
def engine_on(
    scheduler: str | None, resource: str | None, limits: dict[str, Any], *, dask: bool
) -> Iterator[DaskEngine | None]:
    """The engine of a cluster, or None for this machine.

    Raises
    ------
    SelectionError
        If the options do not go together.
    EngineError
        If no scheduler answers.
    """
    from aerocues.errors import SelectionError

    if not dask:
        if scheduler or resource:
            raise SelectionError("--scheduler and --resource are for Dask; add --engine dask")
        yield None
        return
    if not scheduler:
        raise SelectionError(
            "--engine dask needs an address; start 'dask scheduler' and give what it prints with "
            "--scheduler tcp://HOST:8786"
        )
    if limits["workers"]:
        raise SelectionError(
            "a cluster has the workers that were started with 'dask worker'; leave --workers out"
        )
    from aerocues.defaults import CALL_TIMEOUT
    from aerocues.evaluation.dask_engine import DaskEngine
    from aerocues.evaluation.dask_scheduler import connected

    with connected(scheduler) as client:
        engine = DaskEngine(client, limits["timeout"], limits["memory_limit"], resource)
        limits.update(timeout=CALL_TIMEOUT, memory_limit=None)  # those of the engine hold
        _tell(engine, scheduler)
        yield engine


def _tell(engine: DaskEngine, scheduler: str) -> None:
    from aerocues.phrases import count

    threads = engine.threads
    if threads:
        said = f"{count(threads, 'unit')} at a time on the workers of {scheduler}"
    else:
        option = f" --resources {engine.resource}=1" if engine.resource else ""
        said = (
            f"no {engine.worker_wanted} is there yet; start some with "
            f"'dask worker {scheduler} --nthreads 1{option}'"
        )
    sys.stderr.write(f"{said}\ndashboard {engine.dashboard or 'none at this scheduler'}\n")


def machine_lines(table: pl.DataFrame) -> list[str]:
    """Which kinds of machine measured how many rows; nothing where it was a single one."""
    from aerocues.phrases import count

    counts = sorted(table["machine"].drop_nulls().value_counts().iter_rows())
    if len(counts) < 2:
        return []
    each = "; ".join(f"{count(rows, 'row')} on {machine}" for machine, rows in counts)
    return [f"machines {each}"]
