"""The nearest of a fixed list of features, for tools that have no other ones."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from aerocues.methods.combination import Combination

Kind = tuple[str, str]
"""Detector and descriptor."""


@dataclass(frozen=True)
class Nearest:
    """What of a list comes nearest.

    Parameters
    ----------
    combination : Combination
        The combination itself where its features are in the list.
    reason : str
        Why, in words; empty for the combination itself.
    """

    combination: Combination
    reason: str


def nearest(wanted: Combination, listed: Collection[Kind], ranked: Sequence[str] | None) -> Nearest:
    """The features of a list that come nearest to a combination.

    Parameters
    ----------
    wanted : Combination
    listed : collection of (detector, descriptor)
    ranked : sequence of str or None
        Measured combinations from the best to the worst: the best of the list was measured and
        is taken. Where none was, features with the same descriptor come first, then those
        with the same detector.
    """
    if (wanted.detector, wanted.descriptor) in listed:
        return Nearest(wanted, "")
    for rank, name in enumerate(ranked or (), start=1):
        one = Combination.parse(name)
        if (one.detector, one.descriptor) in listed:
            return Nearest(
                one, f"the best of its list that was measured: rank {rank} of {len(ranked or ())}"
            )
    same = [kind for kind in listed if kind[1] == wanted.descriptor]
    reason = "it has the same descriptor"
    if not same:
        same = [kind for kind in listed if kind[0] == wanted.detector]
        reason = "it has the same detector"
    if not same:
        same, reason = [("SIFT", "SIFT")], "the usual choice, as nothing in its list is similar"
    detector, descriptor = same[0]
    norm = "L2" if descriptor in ("SIFT", "KAZE", "DAISY") else "HAM"
    return Nearest(
        Combination(detector, descriptor, norm, wanted.matcher), f"{reason}; it was not measured"
    )
