"""Results that reports are made of: made-up ones, and one finished run with its images."""

from __future__ import annotations

from pathlib import Path

import pytest

import aerocues
from aerocues import Limits, Results
from tests.cli.conftest import write_views
from tests.report.made_up import failed, folder_of, measured

RUN_COMBINATIONS = "ORB-ORB-HAM-BF,AKAZE-AKAZE-HAM-BF,GFTT-BRIEF-HAM-FLANN,SIFT-SIFT-L2-BF"


@pytest.fixture(scope="session")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """Made-up results of 5 combinations on 6 pairs; one failed on a pair, one found chance."""
    rows = measured()
    rows[7] = failed(rows[7])
    rows[13] |= {"status": "chance"}
    return folder_of(rows, tmp_path_factory.mktemp("flight"))


@pytest.fixture(scope="session")
def two_machines(tmp_path_factory: pytest.TempPathFactory) -> list[Results]:
    """The same data set on two machines."""
    return [
        folder_of(measured(machine=name, seed=seed), tmp_path_factory.mktemp(name))
        for seed, name in enumerate(("desk", "board"))
    ]


@pytest.fixture(scope="session")
def photos(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of four overlapping images: three pairs."""
    folder = tmp_path_factory.mktemp("images") / "photos"
    write_views(folder)
    return folder


@pytest.fixture(scope="session")
def finished(photos: Path, tmp_path_factory: pytest.TempPathFactory) -> Results:
    """A finished run of 4 combinations on the 3 pairs of `photos`."""
    output = tmp_path_factory.mktemp("run") / "results"
    return aerocues.run(str(photos), RUN_COMBINATIONS, output, limits=Limits(workers=1))
