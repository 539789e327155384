"""What a decision table accepts, and how it is read from a frame."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import polars as pl
import pytest

from aerocues.errors import ScoreError
from aerocues.scoring import CRITERIA, Criterion, DecisionTable, criteria_named
from tests.scoring.tables import random_table, table_of

NAN = float("nan")
TIME = Criterion("time", "lower")


def read(frame: pl.DataFrame, *criteria: Criterion, **options: str) -> DecisionTable:
    return DecisionTable.from_frame(
        frame, alternative="laptop", criteria=criteria or (TIME,), **options
    )


def laptops() -> pl.DataFrame:
    return pl.DataFrame(
        {
            "laptop": ["b", "b", "a", "a"],
            "run": [2, 1, 2, 1],
            "day": ["mon", "tue", "mon", "tue"],
            "time": [1.0, 2.0, None, 4.0],
            "work": [10, 20, 30, 0],
            "note": ["x", "y", "z", "w"],
        }
    )


def test_values_stand_where_their_names_say() -> None:
    table = read(laptops(), TIME, Criterion("work"), repeat="run", block="day")
    assert table.alternatives == ("a", "b")
    assert table.repeats == ("2", "1")
    np.testing.assert_array_equal(table.values[:, :, 0], [[NAN, 4], [1, 2]])
    np.testing.assert_array_equal(table.values[:, :, 1], [[30, 0], [10, 20]])
    np.testing.assert_array_equal(table.failed[:, :, 0], [[True, False], [False, False]])
    assert table.blocks.tolist() == [0, 1]
    assert table.is_cost.tolist() == [True, False]


def test_without_a_repeat_each_alternative_has_one_row() -> None:
    table = read(pl.DataFrame({"laptop": ["a", "b"], "time": [1, 2]}))
    assert table.repeats == ("all",)
    np.testing.assert_array_equal(table.values, [[[1.0]], [[2.0]]])


def test_a_row_that_is_not_there_was_not_measured() -> None:
    table = read(laptops().slice(1), repeat="run")
    position = table.alternatives.index("b"), table.repeats.index("2")
    assert np.isnan(table.values[position])
    assert not table.failed[position]
    assert table.tried.tolist() == [2, 1]
    np.testing.assert_allclose(table.success_rate, [0.5, 1])


@pytest.mark.parametrize("bad", [None, NAN, float("inf"), -float("inf")])
def test_what_is_no_finite_number_has_failed(bad: float | None) -> None:
    frame = pl.DataFrame({"laptop": ["a", "b"], "time": [bad, 2.0]})
    table = read(frame)
    assert table.failed[:, 0, 0].tolist() == [True, False]
    np.testing.assert_array_equal(table.values[:, 0, 0], [NAN, 2])


def test_a_criterion_may_be_an_expression_of_columns() -> None:
    speed = Criterion("speed", column="work / nullif(time, 0)")
    table = read(laptops(), speed, repeat="run")
    np.testing.assert_array_equal(table.values[:, :, 0], [[NAN, 0], [10, 10]])
    total = read(laptops(), Criterion("total", column="max(work)"), repeat="run")
    assert (total.values == 30).all()


def test_a_division_by_zero_has_failed() -> None:
    table = read(laptops(), Criterion("pace", column="time / work"), repeat="run")
    np.testing.assert_array_equal(table.values[:, :, 0], [[NAN, NAN], [0.1, 0.1]])


@pytest.mark.parametrize(
    ("frame", "options", "message"),
    [
        (laptops().clear(), {}, "row"),
        (laptops(), {"repeat": "round"}, "'round'.* laptop, run"),
        (laptops(), {}, "'b'"),
        (pl.concat([laptops(), laptops()]), {"repeat": "run"}, "repeat '2'"),
        (laptops(), {"repeat": "run", "block": "note"}, "block"),
        (laptops().with_columns(run=None), {"repeat": "run"}, "repeat"),
    ],
)
def test_frames_that_cannot_be_read(
    frame: pl.DataFrame, options: dict[str, str], message: str
) -> None:
    with pytest.raises(ScoreError, match=message):
        read(frame, **options)


@pytest.mark.parametrize(
    ("column", "message"),
    [
        ("note", "String.* 'note'"),
        ("missing", "'missing'.* laptop"),
        ("gt_precision@3", "'gt_precision@3'"),
        ("drop table", "'drop table'"),
        ("time / 0", r"\bit\b"),
    ],
)
def test_columns_that_cannot_be_criteria(column: str, message: str) -> None:
    with pytest.raises(ScoreError, match=message):
        read(laptops(), Criterion("it", column=column), repeat="run")


def test_a_criterion_without_any_value_is_refused() -> None:
    with pytest.raises(ScoreError, match=r"\btime\b"):
        read(laptops().with_columns(time=None), repeat="run")


@pytest.mark.parametrize("value", [float("inf"), -float("inf"), 1.5e308])
def test_infinities_are_refused(value: float) -> None:
    with pytest.raises(ScoreError):
        table_of([[[value], [1.0]]])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"alternatives": ("a", "a")}, "'a'"),
        ({"repeats": ()}, "repeat"),
        ({"criteria": ()}, "criterion"),
        ({"values": np.zeros((2, 2))}, "shape"),
        ({"blocks": np.zeros(3, dtype=np.int64)}, "3 blocks"),
        ({"failed": np.ones((2, 2, 1), dtype=bool)}, "failed"),
        ({"components": {"colour": ("red",)}}, "1 label"),
    ],
)
def test_contradictions_are_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(ScoreError, match=message):
        replace(table_of(np.zeros((2, 2, 1))), **changes)  # type: ignore[arg-type]


def test_success_is_having_no_failed_criterion() -> None:
    values = np.ones((3, 4, 2))
    values[1, 0, 1] = NAN
    values[2] = NAN
    np.testing.assert_allclose(table_of(values).success_rate, [1, 0.75, 0])


def test_fewer_criteria_and_alternatives() -> None:
    table = replace(random_table(0, 4, 3, 3), components={"kind": ("x", "y", "x", "z")})
    fewer = table.without_criterion("c1").with_alternatives([3, 0])
    assert fewer.criterion_names == ("c0", "c2")
    assert fewer.alternatives == ("a3", "a0")
    assert fewer.components == {"kind": ("z", "x")}
    np.testing.assert_array_equal(fewer.values, table.values[[3, 0]][:, :, [0, 2]])


@pytest.mark.parametrize("better", ["Lower", "cost", "min", ""])
def test_a_direction_that_is_none(better: str) -> None:
    with pytest.raises(ScoreError, match=r"price.*'higher' or 'lower'"):
        Criterion("price", better)  # type: ignore[arg-type]


def test_a_table_from_an_array() -> None:
    values = np.array([[1.0, 2.0], [3.0, np.nan]])
    table = DecisionTable.from_values(values, ["a", "b"], [Criterion("x"), Criterion("y")])
    assert table.repeats == ("0",)
    assert table.failed.tolist() == [[[False, False]], [[False, True]]]
    with pytest.raises(ScoreError, match="alternatives, repeats, criteria"):
        DecisionTable.from_values(np.ones(3), ["a"], [Criterion("x")])


def test_criteria_by_name_keep_their_order() -> None:
    chosen = criteria_named(["matches", " recall"])
    assert [criterion.name for criterion in chosen] == ["matches", "recall"]
    assert len({criterion.name for criterion in CRITERIA}) == len(CRITERIA)


@pytest.mark.parametrize(
    ("names", "message"),
    [
        ([], "criteri"),
        (["recal"], "recall"),
        (["recall", "recall"], "recall"),
    ],
)
def test_criteria_that_do_not_exist(names: list[str], message: str) -> None:
    with pytest.raises(ScoreError, match=message):
        criteria_named(names)


def test_names_that_are_lists_are_refused() -> None:
    frame = pl.DataFrame({"laptop": [["a"], ["b"]], "price": [1.0, 2.0]})
    with pytest.raises(ScoreError, match="laptop"):
        DecisionTable.from_frame(frame, alternative="laptop", criteria=[Criterion("price")])
