"""Brute force matching without the wait: the same matches, with times scaled from a part.

Brute force compares every descriptor with every other, at a price that does not depend on what
they are: so it is timed with some of the second descriptors against all of the first, and the
matches come from exact search, which finds the same ones.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aerocues.methods.arrays import Features, Matches
from aerocues.methods.making import MatcherStage
from aerocues.pipeline.clock import Clock, StageTime

# A fortieth of all pairs of descriptors, which takes about as long as exact search; but not so few
# that the time says nothing, and not more than 0.03 s (bits) to 0.2 s (200 numbers) each.
TIMED_SHARE = 1 / 40
FEWEST_TIMED, MOST_TIMED = 50_000, 2_000_000
FEWEST_ROWS = 16


@dataclass(frozen=True)
class SampledBruteForce:
    """Matches as OpenCV's brute force does, timed on a part.

    Parameters
    ----------
    brute_force : MatcherStage
    norm : str
    clock : Clock
    """

    brute_force: MatcherStage
    norm: str
    clock: Clock

    def match(self, first: Features, second: Features) -> tuple[Matches, StageTime]:
        """All matches, and the time that brute force would take for them."""
        timed = min(max(TIMED_SHARE * len(first) * len(second), FEWEST_TIMED), MOST_TIMED)
        rows = max(int(timed) // max(len(first), 1), FEWEST_ROWS)
        if rows >= len(second):
            raw, time = self.clock.time(lambda: self.brute_force.call(first, second))
            return self.brute_force.read(raw), time
        chosen = np.linspace(0, len(second) - 1, rows).round().astype(np.intp)
        part = second.take(chosen)
        _, time = self.clock.time(lambda: self.brute_force.call(first, part))
        # Loads numba, which other timings do without.
        from aerocues.methods.exact.matching import mutual_nearest

        scale = len(second) / rows
        matches = mutual_nearest(first, second, self.norm)
        return matches, StageTime(time.wall * scale, time.cpu * scale)
