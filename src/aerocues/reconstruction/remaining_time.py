"""Whether there is time for another model before a deadline, by the models made so far."""

from __future__ import annotations

import math
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping

from aerocues.methods.combination import Combination
from aerocues.results.metrics import Row

# A process with so much of a core leaves others what it does not need.
OWN_CORE = 0.75


class RemainingTime:
    """The time that is left, and what another model needs: the mean of those made so far.

    All models of a scene are of the same images and pairs. COLMAP's default, which matches other
    pairs in another way, tells nothing of the others.

    Parameters
    ----------
    deadline : float
        By `clock`; infinite where there is none.
    clock : callable
        Returns seconds.
    """

    def __init__(self, deadline: float, clock: Callable[[], float] = time.monotonic) -> None:
        self.limited = deadline < math.inf
        self._deadline, self._clock = deadline, clock
        self._needed: dict[Combination, float] = defaultdict(float)
        self._made: set[Combination] = set()

    @property
    def left(self) -> float:
        """Seconds; never negative."""
        return max(self._deadline - self._clock(), 0.0)

    @property
    def needed(self) -> float | None:
        """Seconds of another model; None as long as none is made."""
        seconds = [self._needed[each] for each in self._made]
        return sum(seconds) / len(seconds) if seconds else None

    def learn(self, rows: Mapping[Combination, Row]) -> None:
        """Take models that were made earlier by their CPU seconds."""
        for combination, row in rows.items():
            if seconds := row.get("reconstruction_seconds"):
                self.worked(combination, seconds, made=True)

    def worked(self, combination: Combination, seconds: float, *, made: bool) -> None:
        """A process has worked so long for a model, which may be made by now."""
        self._needed[combination] += seconds
        if made:
            self._made.add(combination)

    def allows(self, core_shares: Iterable[float]) -> bool:
        """Whether another model may be begun: there is time for it, and it slows no other down.

        Parameters
        ----------
        core_shares : iterable of float
            How much of a core each process that is at work has had, 0 to 1.
        """
        if not self.limited:
            return True
        enough = (self.needed or 0.0) <= self.left
        return enough and all(share >= OWN_CORE for share in core_shares)
