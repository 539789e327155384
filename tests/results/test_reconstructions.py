"""Figures of 3D reconstructions in a results folder."""

from __future__ import annotations

from pathlib import Path

import polars as pl
import pytest

from aerocues.errors import DamageWarning
from aerocues.results.measured_results import Results
from aerocues.results.reconstruction_schema import RECONSTRUCTIONS
from aerocues.results.store import Store

NAMES = [column.name for column in RECONSTRUCTIONS]


@pytest.fixture
def store(tmp_path: Path) -> Store:
    made = Store.create(tmp_path / "results")
    made.write_run({"settings_key": "now"})
    return made


def figures(*detectors: str) -> pl.DataFrame:
    return pl.DataFrame(
        {
            "detector": detectors,
            "points_3d": [100.0] * len(detectors),
            "dataset": "d",
            "descriptor": "ORB",
            "norm": "HAM",
            "matcher": "BF",
        }
    )


def test_without_any_the_table_is_empty(store: Store) -> None:
    table = Results(store.folder).reconstructions()
    assert table.shape == (0, len(NAMES))
    assert table.columns == NAMES


def test_they_come_back_in_a_fixed_order_with_their_types(store: Store) -> None:
    store.write_reconstructions(figures("ORB", "AKAZE"))
    table = Results(store.folder).reconstructions()
    assert table.columns == NAMES
    assert table["detector"].to_list() == ["AKAZE", "ORB"]
    assert table.schema["points_3d"] == pl.Int64
    assert table["reprojection_error"].to_list() == [None, None]
    store.write_reconstructions(figures("SIFT"))
    assert store.reconstructions()["detector"].to_list() == ["SIFT"]
    assert {path.name for path in store.folder.iterdir()} == {
        "parts",
        "run.json",
        "reconstructions.parquet",
    }


def test_columns_that_came_later_do_not_matter(store: Store) -> None:
    file = store.folder / "reconstructions.parquet"
    figures("ORB").with_columns(points_3d=pl.lit(3, pl.Int64), later=pl.lit(1)).write_parquet(file)
    table = store.reconstructions()
    assert table.columns == NAMES
    assert table["points_3d"].to_list() == [3]


def test_they_can_be_queried(store: Store) -> None:
    store.write_reconstructions(figures("ORB", "AKAZE"))
    answer = Results(store.folder).sql("select sum(points_3d) as points from reconstructions")
    assert answer.to_dicts() == [{"points": 200}]


def test_a_damaged_file_is_told(store: Store) -> None:
    (store.folder / "reconstructions.parquet").write_bytes(b"nothing")
    with pytest.warns(DamageWarning, match=str(store.folder)):
        assert store.reconstructions().is_empty()


def test_a_folder_that_has_nothing_else_is_still_its_own(store: Store) -> None:
    store.write_reconstructions(figures("ORB"))
    (store.folder / "run.json").unlink()
    with Store.create(store.folder).writing():
        assert len(store.reconstructions()) == 1
