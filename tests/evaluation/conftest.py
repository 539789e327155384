"""Fixtures of the tests of evaluation."""

from __future__ import annotations

import pytest

from aerocues.datasets.dataset import Dataset
from tests.evaluation.scenes import strip, write_dataset


@pytest.fixture(scope="session")
def views(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Four overlapping views, neighbours paired."""
    return write_dataset(tmp_path_factory.mktemp("views"), strip(4))
