"""Fixtures that every test may use."""

from __future__ import annotations

import os
from pathlib import Path

# As in the processes of aerocues: beside others, threads of matrix products mostly wait for each
# other, and burn time while they do. It counts before numpy is imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import pytest
from hypothesis import settings

from aerocues.datasets.dataset import Dataset

# A crowded machine is no failure, and the same commit is to give the same answer wherever it is
# checked; at the desk, new examples are tried every time.
settings.register_profile("everywhere", deadline=None)
settings.register_profile("check", deadline=None, derandomize=True)
settings.load_profile("check" if os.environ.get("CI") else "everywhere")

REPOSITORY = Path(__file__).resolve().parent.parent


@pytest.fixture(scope="session", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Keep what is remembered of plug-ins out of the home of whoever runs the tests.

    All processes of a run of the tests share it: each plug-in is tried once.
    """
    root = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        root = root.parent
    os.environ["AEROCUES_CACHE"] = str(root / "cache")


@pytest.fixture(scope="session")
def repository() -> Path:
    """The root of the checkout."""
    return REPOSITORY


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of real images that is too large for the repository; skips where it is missing."""
    folder = Path(os.environ.get("AEROCUES_SHARED_DATA", REPOSITORY.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip("no shared data; set AEROCUES_SHARED_DATA to the folder that holds oxford/")
    return folder.resolve()


@pytest.fixture(scope="session")
def views(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Four overlapping views, neighbours paired."""
    from tests.evaluation.scenes import strip, write_dataset

    return write_dataset(tmp_path_factory.mktemp("views"), strip(4))


@pytest.fixture(scope="session")
def strips(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two strips of three images, the second one flown back."""
    import cv2

    from tests.pipeline.test_survey import flight

    folder = tmp_path_factory.mktemp("strips")
    for image in flight():
        assert cv2.imwrite(str(folder / image.name), image.read().bgr)
    return folder


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests that use the fixture `shared_data`, so that `-m` can select them.

    The tests of simulated flights come first: neighbours go to one of several processes, and each
    would take half a minute to compile what renders.
    """
    for item in items:
        if "shared_data" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.shared_data)
    items.sort(key=lambda item: {"airsim", "simulation"}.isdisjoint(item.path.parts))
