"""The public interface from Python."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

import pytest

import aerocues
from aerocues import Combination
from tests.cli.conftest import write_views


def test_every_public_name_can_be_had() -> None:
    for name in aerocues.__all__:
        assert getattr(aerocues, name) is not None
    assert dir(aerocues) == sorted(aerocues.__all__)
    assert aerocues.__version__ == importlib.metadata.version("aerocues")


def test_other_names_cannot() -> None:
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        aerocues.nothing  # noqa: B018


def test_a_measurement_from_python(tmp_path: Path) -> None:
    write_views(tmp_path / "photos")
    dataset = aerocues.open_dataset(str(tmp_path / "photos"), max_pairs=2)
    combinations: list[Combination | str] = [
        Combination.parse("ORB-ORB-HAM-BF"),
        "orb-brief-ham-bf",
    ]
    results = aerocues.run(dataset, combinations, tmp_path / "results", workers=1, seed=3)
    table = results.table()
    assert table["pair"].to_list() == [0, 0, 1, 1]
    assert set(table["status"]) == {"ok"}
    assert set(table["seed"]) == {3}
    assert results.status().left == 0
    best = aerocues.score(results).frame("combination")
    assert set(best["combination"]) == {"ORB-ORB-HAM-BF", "ORB-BRIEF-HAM-BF"}
    reopened = aerocues.Results(tmp_path / "results")
    assert reopened.sql("select count(*) as n from results")["n"].item() == 4


def test_one_kind_of_error_covers_all(tmp_path: Path) -> None:
    with pytest.raises(aerocues.AerocuesError):
        aerocues.open_dataset(str(tmp_path / "missing"))
    with pytest.raises(aerocues.AerocuesError):
        aerocues.Results(tmp_path)
