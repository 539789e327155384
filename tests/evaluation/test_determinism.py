"""The same measurement gives the same rows, whoever does it and in whatever order."""

from __future__ import annotations

import functools
from pathlib import Path

import pytest

from aerocues.datasets.dataset import Dataset
from aerocues.evaluation import run as running
from aerocues.methods.registry import opencv_methods
from tests.evaluation.inline import InlineEngine
from tests.evaluation.scenes import Rows, assert_same_rows, rows_of, strip, write_dataset

# Times are not the point: each pair is measured once.
run = functools.partial(running.run, timing="shared")
# Every detector, every descriptor, both matchers: FLANN is random without a seed.
DETECTORS = [name for name, row in opencv_methods().detectors.items() if not row.of_pairs]
COMBINATIONS = [
    *(f"{name}-SIFT-L2-FLANN" for name in DETECTORS if name != "MSD"),
    *(f"{name}-BRIEF-HAM-FLANN" for name in DETECTORS),
    *(f"KAZE-{d}-HAM-BF" for d in ("BRISK", "FREAK", "LUCID", "LATCH", "BEBLID")),
    "AKAZE-AKAZE-HAM-BF",
    *(f"KAZE-{d}-L2-BF" for d in ("KAZE", "VGG", "DAISY")),
    *(f"ORB-{d}-HAM-BF" for d in ("ORB", "TEBLID", "BOOST")),
]
UNSTABLE = {name for name, row in opencv_methods().detectors.items() if row.unstable}


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    return write_dataset(tmp_path_factory.mktemp("images"), strip(2, 320, 200))


def measured(dataset: Dataset, folder: Path, workers: int, combinations: list[str]) -> Rows:
    results = run(dataset, combinations, folder, workers=workers)
    return rows_of(results.table())


def without_crashes(rows: Rows, other: Rows) -> Rows:
    """Leave out rows of unstable detectors that crashed in either run."""

    def crashed(row: dict[str, object]) -> bool:
        return row["detector"] in UNSTABLE and row["status"] == "crashed"

    return {n: row for n, row in rows.items() if not crashed(row) and not crashed(other[n])}


@pytest.mark.slow
def test_workers_and_order_do_not_change_a_row(dataset: Dataset, tmp_path: Path) -> None:
    one = measured(dataset, tmp_path / "one", 1, COMBINATIONS)
    assert len(one) == len(COMBINATIONS)
    errors = {name: row["message"] for name, row in one.items() if row["status"] == "error"}
    assert not errors
    assert sum(row["status"] == "ok" for row in one.values()) > len(one) / 2
    two = measured(dataset, tmp_path / "two", 2, COMBINATIONS[::-1])
    assert two.keys() == one.keys()
    assert_same_rows(without_crashes(two, one), without_crashes(one, two))


@pytest.mark.slow
def test_a_combination_alone_gives_the_rows_that_it_gives_among_others(
    views: Dataset, tmp_path: Path
) -> None:
    together = run(
        views,
        "ORB-ORB-HAM-*,ORB-BRIEF-HAM-FLANN,BRISK-ORB-HAM-FLANN,BRISK-FREAK-HAM-FLANN",
        tmp_path / "together",
        engine=InlineEngine(),
    )
    everything = rows_of(together.table())
    for text in ("ORB-BRIEF-HAM-FLANN", "BRISK-FREAK-HAM-FLANN"):
        alone = rows_of(run(views, text, tmp_path / text, engine=InlineEngine()).table())
        assert len(alone) == 3
        assert_same_rows({name: everything[name] for name in alone}, alone)


def test_a_selection_of_pairs_gives_the_rows_of_the_whole(views: Dataset, tmp_path: Path) -> None:
    whole = rows_of(run(views, "ORB-ORB-HAM-FLANN", tmp_path / "w", engine=InlineEngine()).table())
    last = Dataset(views.name, views.images[2:], views.pairs[2:], views.geometry)
    context = run(last, "ORB-ORB-HAM-FLANN", tmp_path / "l", engine=InlineEngine())
    rows = rows_of(context.table())
    assert {name[1] for name in rows} == {2}
    assert_same_rows({name: whole[name] for name in rows}, rows)
