"""What every engine does: take units, give back their rows, whatever happens to a process."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Protocol

from aerocues.evaluation.unit import Context, Unit
from aerocues.progress import Watch
from aerocues.results.metrics import Row


@dataclass(frozen=True)
class Finished:
    """A part of a unit that is settled, with its rows: a pair, or what had to be given up."""

    unit: Unit
    rows: list[Row]


class Engine(Protocol):
    """Runs units somewhere. The order in which they finish is not defined; their rows are."""

    def run(
        self, units: Sequence[Unit], context: Context, watch: Watch
    ) -> Generator[Finished, None, None]:
        """Run all units.

        Parameters
        ----------
        units : sequence of Unit
            In the order in which they are to be begun.
        context : Context
        watch : callable
            Told several times a second what the workers are doing.

        Yields
        ------
        Finished
            Each row of each unit exactly once, failed ones with their status.

        Raises
        ------
        EngineError
            If workers cannot be started.
        """
