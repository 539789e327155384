"""Photos, results of them, and a flight to write."""

from __future__ import annotations

from tests.cli.conftest import finished, photos
from tests.exports.written_flight import flight, scene

__all__ = ["finished", "flight", "photos", "scene"]
