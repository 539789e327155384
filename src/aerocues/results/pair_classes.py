"""Classes of pairs by the rotation between the two images."""

from __future__ import annotations

from typing import Literal

PairClass = Literal["turned", "other"]
PAIR_CLASSES: tuple[PairClass, ...] = ("turned", "other")
TURNED = 60.0
"""Degrees. Neighbouring strips of a survey are turned by about 180; methods without orientation
tolerate 15 to 40 degrees; cross strips are turned by about 90."""


def pair_class(turn: float) -> PairClass:
    """The class of a pair.

    Parameters
    ----------
    turn : float
        Degrees, 0 to 180, by which image 2 is turned against image 1 at its centre.
    """
    return "turned" if turn > TURNED else "other"
