"""Norms and matchers, one row each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from aerocues.methods.descriptors import DescriptorType
from aerocues.methods.parameters import AEROCUES, OPENCV, Value


@dataclass(frozen=True)
class NormRow:
    """One norm: its name in a combination, the constant of OpenCV and what it is."""

    name: str
    constant: str
    title: str


@dataclass(frozen=True)
class MatcherRow:
    """One matcher.

    Parameters
    ----------
    name : str
        As it stands in a combination, upper case.
    title, reference : str
        What it is and where it was published.
    parameters : mapping of norm to parameters
        What it is given for each norm that it supports.
    dtypes : mapping of norm to descriptor types
        The element types that it can match under each norm.
    factory : str
        The class of OpenCV that matches, a key of `aerocues.methods.making.OPENCV_MATCHERS`, or
        ``module:attribute`` of a plug-in or of aerocues.
    takes_descriptors : tuple of str
        The only descriptors that it matches; empty: all of its types.
    of_pairs : bool
        Whether it is a pair matcher: two images in, positions that belong together out.
    on_request, upright, origin, unavailable
        As for a detector.
    """

    name: str
    title: str
    reference: str
    parameters: Mapping[str, Mapping[str, Value]] = field(repr=False)
    dtypes: Mapping[str, tuple[DescriptorType, ...]] = field(repr=False)
    factory: str
    takes_descriptors: tuple[str, ...] = ()
    of_pairs: bool = False
    on_request: str = ""
    upright: bool = False
    origin: str = OPENCV
    unavailable: str | None = None


NORMS: tuple[NormRow, ...] = (
    NormRow("L2", "NORM_L2", "Euclidean distance"),
    NormRow("HAM", "NORM_HAMMING", "Hamming distance: the number of bits that differ"),
)

MATCHERS: tuple[MatcherRow, ...] = (
    MatcherRow(
        "BF",
        "brute force, cross-checked",
        "exact nearest neighbours",
        {"L2": {}, "HAM": {}},
        {"L2": ("float32", "uint8"), "HAM": ("uint8",)},
        factory="BFMatcher",
    ),
    MatcherRow(
        "FLANN",
        "approximate nearest neighbours both ways, mutual ones kept",
        "Muja and Lowe, Fast approximate nearest neighbors, VISAPP 2009",
        {
            "L2": {"algorithm": 1, "trees": 5, "checks": 50},
            "HAM": {
                "algorithm": 6,
                "table_number": 6,
                "key_size": 12,
                "multi_probe_level": 1,
                "checks": 50,
            },
        },
        {"L2": ("float32",), "HAM": ("uint8",)},
        factory="FlannBasedMatcher",
    ),
)

EXACT = MatcherRow(
    "EXACT",
    "the matches of BF, many times sooner; only where it is named",
    "exact nearest neighbours by counted bits and products of matrices",
    {"L2": {}, "HAM": {}},
    {"L2": ("float32", "uint8"), "HAM": ("uint8",)},
    factory="aerocues.methods.exact.matching:ExactMatcher",
    on_request="exact",
    origin=AEROCUES,
)
"""What aerocues itself adds to OpenCV's matchers."""
