"""Waiting for other processes, for as long as it takes: pytest ends a test that waits in vain."""

from __future__ import annotations

import time
from collections.abc import Callable


def wait_until(done: Callable[[], object]) -> None:
    while not done():
        time.sleep(0.02)
