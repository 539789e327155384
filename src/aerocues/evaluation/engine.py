"""The interface of engines: they take units and return all rows, even if processes die."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Protocol

from aerocues.evaluation.unit import Context, Unit
from aerocues.progress import Watch
from aerocues.results.metrics import Row


@dataclass(frozen=True)
class Finished:
    """A finished part of a unit with its rows: a pair, or work that was given up."""

    unit: Unit
    rows: list[Row]


class Engine(Protocol):
    """Runs units. The order in which they finish is undefined, but their rows are not affected."""

    def run(
        self, units: Sequence[Unit], context: Context, watch: Watch
    ) -> Generator[Finished, None, None]:
        """Run all units.

        Parameters
        ----------
        units : sequence of Unit
            In the order in which to start them.
        context : Context
        watch : callable
            Called several times per second with the activity of the workers.

        Yields
        ------
        Finished
            Each row of each unit exactly once; failed rows have their status.

        Raises
        ------
        EngineError
            If workers cannot be started.
        """
