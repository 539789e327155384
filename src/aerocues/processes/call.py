"""What a worker announces before it calls a method."""

from __future__ import annotations

from dataclasses import dataclass

NO_PAIR = -1
"""In place of a pair's number where an image is worked on by itself."""


OF_PAIRS = ("match", "verify")
"""Stages of pairs of images; the others are of one image."""


@dataclass(frozen=True)
class StageCall:
    """The call that a worker is in: what to blame if the process does not survive it.

    `number` of `total` tells how far it is with images or pairs, where that is known.
    """

    stage: str
    pair: int
    image: str
    detector: str
    descriptor: str = ""
    combination: str = ""
    number: int = 0
    total: int = 0

    def __str__(self) -> str:
        return f"{self.stage} {self.method} on {self.image}"

    @property
    def method(self) -> str:
        """What is called: a combination, or a detector and a descriptor."""
        return self.combination or "-".join(filter(None, (self.detector, self.descriptor)))

    def brief(self) -> str:
        """``match pair 5 of 17, ORB-ORB-HAM-BF``: how far it is where that is known."""
        if not self.total:
            return str(self)
        unit = "pair" if self.stage in OF_PAIRS else "image"
        return f"{self.stage} {unit} {self.number} of {self.total}, {self.method}"
