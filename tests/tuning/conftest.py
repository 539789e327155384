"""The images, the results and the command line of the other tests."""

from __future__ import annotations

from tests.cli.conftest import call, finished, photos

__all__ = ["call", "finished", "photos"]
