"""The order of units: the most expensive first, followed by those that share its images."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from aerocues.datasets.dataset import Dataset
from aerocues.evaluation.unit import Unit


class UnitQueue:
    """Units in the order in which to start them.

    Neighbouring units of a detector share an image. A worker that has finished one of them gets the
    next, because it still has the features of the shared image; other workers avoid this unit if
    they can.

    Parameters
    ----------
    units : sequence of Unit
        The most expensive first.
    dataset : Dataset
    """

    def __init__(self, units: Sequence[Unit], dataset: Dataset) -> None:
        self._left = list(units)
        self._dataset = dataset
        self._images: dict[tuple[int, ...], frozenset[str]] = {}

    def __bool__(self) -> bool:
        return bool(self._left)

    def put_back(self, units: Iterable[Unit]) -> None:
        """Put units at the front."""
        self._left[:0] = units

    def take(self, finished: Unit | None, begun: Collection[Unit]) -> Unit:
        """The next unit for a worker; IndexError if there is none.

        Parameters
        ----------
        finished : Unit or None
            The latest unit of the worker.
        begun : collection of Unit
            The current units of other workers.
        """
        place = 0
        if finished is not None:
            follower = (i for i, unit in enumerate(self._left) if self._shares(unit, finished))
            place = next(follower, -1)
        if finished is None or place < 0:
            free = (
                i
                for i, unit in enumerate(self._left)
                if not any(self._shares(unit, other) for other in begun)
            )
            place = next(free, 0)
        return self._left.pop(place)

    def _shares(self, unit: Unit, other: Unit) -> bool:
        """Whether one unit can use the features of the other."""
        same = unit.detector == other.detector
        return same and not self._images_of(unit).isdisjoint(self._images_of(other))

    def _images_of(self, unit: Unit) -> frozenset[str]:
        key = tuple(work.pair for work in unit.work)
        if key not in self._images:
            pairs = [self._dataset.pair(number) for number in key]
            self._images[key] = frozenset(
                name for pair in pairs for name in (pair.image_1, pair.image_2)
            )
        return self._images[key]
