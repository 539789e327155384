"""A combination of detector, descriptor, norm and matcher, and its text form."""

from __future__ import annotations

import re
from dataclasses import dataclass

from aerocues.errors import SelectionError

METHOD_NAME = re.compile(r"[A-Z0-9_]+")
NONE = "NONE"
"""The descriptor and the norm of pair matchers, which need neither."""


@dataclass(frozen=True, order=True)
class Combination:
    """What is evaluated; its text form is ``ORB-BEBLID-HAM-BF``.

    That of a pair matcher is ``PIXELMAP-NONE-NONE-PIXELMAP``: it finds the positions itself, and
    needs neither descriptors nor a norm. ``ORB-NONE-NONE-PIXELMAP`` are keypoints of ORB that it
    guides.

    Parameters
    ----------
    detector, descriptor, norm, matcher : str
        Names of methods in capitals, as 'aerocues methods' lists them.

    Raises
    ------
    SelectionError
        If a name is malformed.
    """

    detector: str
    descriptor: str
    norm: str
    matcher: str

    def __post_init__(self) -> None:
        for name in (self.detector, self.descriptor, self.norm, self.matcher):
            if not METHOD_NAME.fullmatch(name):
                raise SelectionError(
                    f"{name!r} is no method name; names consist of A-Z, 0-9 and _ "
                    "(see 'aerocues methods')"
                )

    def __str__(self) -> str:
        return f"{self.detector}-{self.descriptor}-{self.norm}-{self.matcher}"

    @property
    def of_pairs(self) -> bool:
        """Whether a pair matcher matches."""
        return self.descriptor == NONE

    @property
    def guided(self) -> bool:
        """Whether a pair matcher guides the keypoints of a detector."""
        return self.of_pairs and self.detector != self.matcher

    @classmethod
    def of_pair_matcher(cls, name: str) -> Combination:
        """The combination of a pair matcher."""
        return cls(name, NONE, NONE, name)

    @classmethod
    def parse(cls, text: str) -> Combination:
        """Read the text form, in any case.

        Raises
        ------
        SelectionError
            If `text` does not have four parts.
        """
        parts = text.strip().upper().split("-")
        if len(parts) != 4:
            raise SelectionError(
                f"{text!r} is no combination; write DETECTOR-DESCRIPTOR-NORM-MATCHER, "
                "such as ORB-BEBLID-HAM-BF"
            )
        return cls(*parts)
