"""Fixtures of the tests of methods."""

from __future__ import annotations

import pytest

from aerocues.methods.registry import Methods, opencv_methods


@pytest.fixture(scope="session")
def methods() -> Methods:
    """OpenCV's methods alone, whatever plug-ins this machine has."""
    return opencv_methods()
