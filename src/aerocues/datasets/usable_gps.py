"""Which GPS positions of a flight can be right; the others are named and left out.

A receiver without a fix writes zeros, a camera that lost it writes an old position, and software
that copies tags loses altitudes. One such position would stretch the extent of a whole flight.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import GpsPosition
from aerocues.datasets.gps import east_north_up

JUMP = 3.0
"""A position is far where its distance from the middle is this many times that of the last before
it; images of a survey lie much closer together."""
NEAR = 200.0
"""Metres from the middle, or in height, within which a position is never far: it hardly changes
what counts as in its place."""
MOST_FAR = 1 / 3
"""If more positions than this share are far, the flight has several parts."""
FEWEST = 4
"""Of fewer positions, none can be told to be far from the others."""
SEA_LEVEL = 10.0
"""Metres: an altitude of exactly 0 is a missing one if no other is as low as this."""

MOST_NAMED = 3

Array = NDArray[np.float64]
Faults = list[str | None]


@dataclass(frozen=True)
class UsableGps:
    """The GPS positions of images, with what is wrong with them.

    Parameters
    ----------
    positions : tuple of GpsPosition or None
        Of the images, in their order.
    in_plan, in_height : tuple of str or None
        Why the horizontal position, or the altitude, cannot be used; None: it can.
    """

    positions: tuple[GpsPosition | None, ...]
    in_plan: tuple[str | None, ...]
    in_height: tuple[str | None, ...]

    @classmethod
    def of(cls, positions: Sequence[GpsPosition | None]) -> UsableGps:
        """Examine the positions of the images of one scene."""
        plan = _plan_faults(positions)
        return cls(tuple(positions), tuple(plan), tuple(_height_faults(positions, plan)))

    @property
    def faults(self) -> Faults:
        """Why each position is left out where both place and height matter; None: it is not."""
        return [plan or height for plan, height in zip(self.in_plan, self.in_height, strict=True)]

    def horizontal(self) -> Array | None:
        """Metres east and north, (N, 2); None if fewer than half of the positions can be used.

        Images without a usable position are placed between their neighbours in the order.
        """
        known = [number for number, fault in enumerate(self.in_plan) if fault is None]
        if 2 * len(known) < len(self.positions) or not known:
            return None
        located = east_north_up([self.positions[number] or _NOWHERE for number in known])[:, :2]
        order = np.arange(len(self.positions))
        return np.column_stack([np.interp(order, known, axis) for axis in located.T])


def told_left_out(left_out: Mapping[str, str]) -> str:
    """``GPS left out: a (altitude 0), b (5.5 km from the others)``, from reasons by name."""
    listed = [f"{name} ({why})" for name, why in list(left_out.items())[:MOST_NAMED]]
    more = f" and {len(left_out) - MOST_NAMED} more" if len(left_out) > MOST_NAMED else ""
    return f"GPS left out: {', '.join(listed)}{more}"


_NOWHERE = GpsPosition(0.0, 0.0)


def _plan_faults(positions: Sequence[GpsPosition | None]) -> Faults:
    faults: Faults = [None if each else "no GPS position" for each in positions]
    for axis in ("latitude", "longitude"):
        zero = [i for i, each in enumerate(positions) if each and getattr(each, axis) == 0]
        if len(zero) <= MOST_FAR * len(positions):
            for number in zero:
                faults[number] = f"{axis} 0"
    known = [(i, each) for i, each in enumerate(positions) if each and not faults[i]]
    if len(known) < FEWEST:
        return faults
    located = east_north_up([GpsPosition(p.latitude, p.longitude) for _, p in known])
    distances = np.linalg.norm(located - np.median(located, axis=0), axis=1)
    for index in _far(distances):
        faults[known[index][0]] = f"{_metres(distances[index])} from the others"
    return faults


def _height_faults(positions: Sequence[GpsPosition | None], plan: Faults) -> Faults:
    faults: Faults = [None] * len(positions)
    # What is right decides what is not, so a position without a place does not take part.
    placed = {i: each.altitude for i, each in enumerate(positions) if each and not plan[i]}
    known = {i: altitude for i, altitude in placed.items() if altitude is not None}
    if 2 * len(known) < len(placed) or not known:
        return faults  # none has a height to compare with: all are at the same level
    for number in placed.keys() - known.keys():
        faults[number] = "no altitude"
    others = [altitude for altitude in known.values() if altitude != 0]
    if others and 2 * len(others) > len(known) and min(map(abs, others)) > SEA_LEVEL:
        for number, altitude in known.items():
            if altitude == 0:
                faults[number] = "altitude 0"
    left = [number for number in known if not faults[number]]
    heights = np.array([known[number] for number in left])
    distances = np.abs(heights - np.median(heights))
    for index in _far(distances):
        faults[left[index]] = f"altitude {_metres(distances[index])} from the others"
    return faults


def _far(distances: Array) -> list[int]:
    """Indices of those beyond a jump in the distances from the middle."""
    order = np.argsort(distances, kind="stable")
    ordered = distances[order]
    least = max(int(np.ceil((1 - MOST_FAR) * len(ordered))), 1)
    for number in range(least, len(ordered)):
        if ordered[number] > max(JUMP * ordered[number - 1], NEAR):
            return [int(index) for index in order[number:]]
    return []


def _metres(distance: float) -> str:
    return f"{distance / 1000:,.1f} km" if distance >= 1000 else f"{distance:.0f} m"
