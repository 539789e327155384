"""Handles units in which Dask workers died."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from aerocues.evaluation.engine import Finished
from aerocues.evaluation.giving_up import settle_loss
from aerocues.evaluation.unit import Context, Unit
from aerocues.processes.call import StageCall
from aerocues.processes.child_process import Loss

if TYPE_CHECKING:
    from distributed import KilledWorker

    from aerocues.evaluation.dask_worker import Report

# Dask blames all units of a lost worker, including waiting ones. A unit is retried this often if no
# lost worker reported that it was running it.
UNTOLD = 2


def call_of(report: Report) -> StageCall | None:
    """The stage call that a worker was running."""
    return StageCall(**report["call"]) if report["call"] else None  # type: ignore[arg-type]


class DaskLosses:
    """Divides units that killed workers, until the faulty call is isolated and given up.

    Parameters
    ----------
    context : Context
    """

    def __init__(self, context: Context) -> None:
        self._context = context
        self._machines: dict[str | None, str] = {}
        self._untold: Counter[Unit] = Counter()

    def hear(self, report: Report) -> None:
        """Handle the report of a worker."""
        self._machines[_host(report["worker"])] = report["machine"]

    def settle(
        self, unit: Unit, report: Report | None, error: KilledWorker
    ) -> tuple[Finished | None, list[Unit]]:
        """What to give up of a unit, and what to retry; `report` is the latest report."""
        last, deaths = error.last_worker.address, error.allowed_failures + 1
        call, told = None, ""
        if report is not None and report["worker"] == last:
            call = call_of(report)
        else:
            self._untold[unit] += 1
            if self._untold[unit] <= UNTOLD:
                return None, [unit]
            deaths *= self._untold.pop(unit)
            told = " before they reported it"
        message = (
            f"{deaths} Dask worker{'s' if deaths > 1 else ''} died in {call or 'this pair'}{told}, "
            f"the last at {last}"
        )
        context = replace(self._context, machine=self._machines.get(_host(last), str(_host(last))))
        return settle_loss(context, unit, Loss("crashed", message, call))


def _host(address: str) -> str | None:
    return urlsplit(address).hostname
