"""What a worker announces before it calls a method."""

from __future__ import annotations

from dataclasses import dataclass

NO_PAIR = -1
"""In place of a pair's number where an image is worked on by itself."""


@dataclass(frozen=True)
class StageCall:
    """The call that a worker is in: what to blame if the process does not survive it."""

    stage: str
    pair: int
    image: str
    detector: str
    descriptor: str = ""
    combination: str = ""

    def __str__(self) -> str:
        method = self.combination or "-".join(filter(None, (self.detector, self.descriptor)))
        return f"{self.stage} {method} on {self.image}"
