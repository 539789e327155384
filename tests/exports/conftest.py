"""Photos, and results of them."""

from __future__ import annotations

from tests.cli.conftest import finished, photos

__all__ = ["finished", "photos"]
