"""How stage times are taken."""

from __future__ import annotations

from typing import Literal

Timing = Literal["exclusive", "shared", "estimated"]
# From what says least of a machine to what says most.
TIMINGS: tuple[Timing, ...] = ("estimated", "shared", "exclusive")
# A call whose wall time is so much longer than its CPU time had to share its core.
DISTURBED = 1.1
