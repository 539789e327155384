"""Several datasets together: the best of each, what stays good, components, by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from aerocues.scoring import ScoreSettings, score
from aerocues.scoring.comparison import Comparison, compare
from aerocues.scoring.cues import Scores
from aerocues.scoring.hierarchy import hierarchy_across
from aerocues.scoring.leaders import best_of_each, consistently_good, kept_in_top
from aerocues.scoring.overview import overview_of
from tests.scoring.tables import table_of


def scored(values: dict[str, float]) -> Scores:
    """Scores that are the values, whose least is 0 and whose largest is 1."""
    names = list(values)
    table = table_of(np.array(list(values.values())).reshape(-1, 1, 1), names=names)
    table = replace(table, components={"kind": tuple(name[0] for name in names)})
    return score(table, ScoreSettings(alpha=1))


ONE = {"a1": 1.0, "a2": 0.5, "b1": 0.25, "b2": 0.0}
TWO = {"a1": 0.75, "a2": 0.0, "b1": 1.0}


@pytest.fixture(scope="module")
def rankings() -> dict[str, Scores]:
    return {"one": scored(ONE), "two": scored(TWO)}


@pytest.fixture(scope="module")
def both(rankings: dict[str, Scores]) -> Comparison:
    return compare(rankings)


def test_the_best_of_each_dataset_and_how_good_it_is_elsewhere(both: Comparison) -> None:
    assert best_of_each(both).rows() == [("one", "a1", 1.0, 4, 0.75), ("two", "b1", 1.0, 3, 0.25)]


def test_what_stays_among_the_first(both: Comparison) -> None:
    np.testing.assert_array_equal(kept_in_top(both, 1), [[1, 0], [0, 1]])
    np.testing.assert_array_equal(kept_in_top(both, 2), [[2, 1], [1, 2]])


def test_consistently_good_is_what_is_good_everywhere(both: Comparison) -> None:
    # Two thirds of 4 and of 3 are 2 places.
    found = consistently_good(both, 2 / 3)
    assert found["alternative"].to_list() == ["a1"]
    row = found.row(0, named=True)
    assert (row["mean"], row["min"], row["worst_rank"]) == (0.875, 0.75, 2)
    assert row["variation"] == pytest.approx(0.125 / 0.875)
    assert consistently_good(both, 0.1).is_empty()


def test_components_count_each_score_of_each_dataset(both: Comparison) -> None:
    found = hierarchy_across(both)["kind"]
    assert found["name"].to_list() == ["a", "b"]
    first = found.row(0, named=True)
    assert first["mean"] == pytest.approx((1 + 0.5 + 0.75 + 0) / 4)
    assert first["standard_deviation"] == pytest.approx(np.std([1, 0.5, 0.75, 0]))
    assert (first["evaluations"], first["best"], first["dataset"]) == (4, "a1", "one")
    second = found.row(1, named=True)
    assert (second["evaluations"], second["max"], second["dataset"]) == (3, 1.0, "two")


def test_machines_of_one_dataset_count_once(rankings: dict[str, Scores]) -> None:
    board = scored({**ONE, "a2": 0.25})
    three = compare({**rankings, "board": board}, datasets=("one", "two", "one"))
    found = hierarchy_across(three)["kind"].row(0, named=True)
    assert found["evaluations"] == 4
    assert found["mean"] == pytest.approx((1 + 0.375 + 0.75 + 0) / 4)
    overview = overview_of(list(rankings.values()), three)
    assert overview.datasets == ("one", "two")
    assert overview.evaluations == 7


def test_an_overview_has_means_over_the_datasets(
    rankings: dict[str, Scores], both: Comparison
) -> None:
    found = overview_of(list(rankings.values()), both)
    assert (found.mean_of_bests, found.range_of_bests) == (1.0, 0.0)
    assert found.mean_correlation == pytest.approx(both.spearman()[0, 1])
    # With a single criterion neither the power nor the weights change a ranking.
    np.testing.assert_allclose(found.alpha.correlation, 1)
    np.testing.assert_allclose(found.aggregation.correlation, 1)
    assert {"Best of each dataset", "Scores of kind"} <= found.tables().keys()
