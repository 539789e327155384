"""How stage times are taken."""

from __future__ import annotations

from typing import Literal

Timing = Literal["exclusive", "shared", "estimated"]
# From the least to the most informative.
TIMINGS: tuple[Timing, ...] = ("estimated", "shared", "exclusive")
# A call whose wall time exceeds its CPU time by this factor shared its core.
DISTURBED = 1.1
