"""Measurement tables made elsewhere become results folders."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path
from typing import Any

import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from polars.testing import assert_frame_equal

import aerocues
from aerocues.errors import StoreError
from aerocues.results.export import export_table
from aerocues.results.importing import import_results
from aerocues.results.measured_results import Results
from aerocues.results.schema import COLUMNS, polars_schema
from aerocues.results.store import Store
from tests.evaluation.tables import figures, measured, write_table


@pytest.fixture
def table(tmp_path: Path) -> Path:
    """One dataset on one platform."""
    return write_table(tmp_path / "table.csv", measured("flight", "board"))


@pytest.mark.parametrize("suffix", ["csv", "parquet", "CSV"])
def test_a_table_becomes_a_results_folder(tmp_path: Path, suffix: str) -> None:
    file = write_table(tmp_path / "table.parquet", measured("flight", "board"))
    if suffix.lower() == "csv":
        pl.read_parquet(file).write_csv(tmp_path / f"table.{suffix}")
    [results] = aerocues.import_results(tmp_path / f"table.{suffix}", tmp_path / "results")
    rows = results.table()
    assert rows.columns == [column.name for column in COLUMNS]
    assert rows["detector"].to_list() == ["ORB", "SIFT", "ORB", "SIFT"]
    assert set(rows["matcher"]) == {"BF", "FLANN"}
    assert set(rows["machine"]) == {"board"}
    assert set(rows["preset"]) == {"imported"}
    assert rows["total_seconds"].to_list() == pytest.approx([0.1, 0.1, 0.101, None])
    assert rows["status"].to_list() == ["ok", "ok", "ok", "error"]
    assert rows["message"].is_null().to_list() == [True, True, True, False]
    status = Results(tmp_path / "results").status()
    assert (status.planned, status.left, status.statuses) == (4, 0, {"ok": 3, "error": 1})
    assert aerocues.score(results).frame()["repeats"].to_list() == [2, 2]


def test_the_form_is_known_by_the_content(tmp_path: Path) -> None:
    file = write_table(tmp_path / "table.parquet", measured("flight", "board"))
    named = file.rename(tmp_path / "table.dat")
    [results] = import_results(named, tmp_path / "results")
    assert len(results.table()) == 4


def test_nan_and_other_signs_for_nothing_are_missing(tmp_path: Path) -> None:
    rows: list[dict[str, Any]] = measured("flight", "board")
    blank = list(rows[0])[7:]
    signs = ("NaN", "nan", "", "NA")
    for row, sign in zip(rows, signs, strict=True):
        row.update(dict.fromkeys(blank, sign))
    [results] = import_results(write_table(tmp_path / "t.csv", rows), tmp_path / "results")
    assert results.table()["status"].to_list() == ["error"] * 4
    assert results.table().select("precision", "inliers").null_count().row(0) == (4, 4)


def test_counts_may_be_written_as_decimal_numbers(tmp_path: Path) -> None:
    rows = [row | {"pair": float(row["pair"])} for row in measured("flight", "board")]
    [results] = import_results(write_table(tmp_path / "t.csv", rows), tmp_path / "results")
    assert results.table()["pair"].to_list() == [0, 0, 1, 1]


def test_what_a_column_says_of_the_outcome_stays(tmp_path: Path) -> None:
    rows = [row | {"status": "ok", "message": None} for row in measured("flight", "board")]
    rows[-1] |= {"status": "no_model", "message": "none"}
    rows[0] |= {"status": "chance"}
    [results] = import_results(write_table(tmp_path / "t.parquet", rows), tmp_path / "results")
    outcomes = results.table().select("status", "message").rows()
    assert outcomes == [("chance", None), ("ok", None), ("ok", None), ("no_model", "none")]


def test_where_it_comes_from_is_recorded(table: Path, tmp_path: Path) -> None:
    [results] = import_results(table, tmp_path / "results")
    facts = results.settings
    origin = facts["imported"]
    assert (origin["file"], origin["dataset"], origin["platform"]) == (
        "table.csv",
        "flight",
        "board",
    )
    assert re.fullmatch("[0-9a-f]{64}", origin["sha256"])
    assert facts["preset"] == "imported"
    assert facts["combinations"] == ["ORB-ORB-HAM-BF", "SIFT-SIFT-L2-FLANN"]


def test_several_platforms_become_a_folder_of_folders(tmp_path: Path) -> None:
    rows = measured("flight", "My Board, 2 cores") + measured("flight", "a/b") + measured("x", None)
    file = write_table(tmp_path / "t.parquet", rows)
    made = import_results(file, tmp_path / "out")
    names = [results.folder.name for results in made]
    assert names == ["flight-My-Board-2-cores", "flight-a-b", "x"]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted(names)
    assert [set(results.table()["machine"]) for results in made] == [
        {"My Board, 2 cores"},
        {"a/b"},
        {None},
    ]
    with pytest.raises(StoreError, match="flight-a-b, x"):
        Results(tmp_path / "out")


def test_names_that_a_file_system_takes_for_one_are_told_apart(tmp_path: Path) -> None:
    rows = measured("..", "/") + measured("a:b", "c") + measured("A b", "C")
    made = import_results(write_table(tmp_path / "t.csv", rows), tmp_path / "out")
    assert [results.folder.name for results in made] == ["unnamed", "a-b-c", "A-b-C-2"]


def test_a_dataset_and_a_platform_can_be_chosen(tmp_path: Path) -> None:
    rows = measured("a", "one") + measured("b", "one") + measured("b", "two")
    file = write_table(tmp_path / "t.csv", rows)
    [results] = import_results(file, tmp_path / "b2", dataset="b", platform="two")
    assert results.folder == tmp_path / "b2"
    assert results.table().select("dataset", "machine").unique().rows() == [("b", "two")]
    assert len(import_results(file, tmp_path / "b", dataset="b")) == 2
    with pytest.raises(StoreError, match=r"t\.csv .*'c'.*\ba, b$"):
        import_results(file, tmp_path / "c", dataset="c")
    with pytest.raises(StoreError, match=r"'two'.*\bone$"):
        import_results(file, tmp_path / "c", dataset="a", platform="two")
    assert not (tmp_path / "c").exists()


def test_what_was_written_as_csv_comes_back(table: Path, tmp_path: Path) -> None:
    [results] = import_results(table, tmp_path / "first")
    export_table(results.table(), tmp_path / "again.csv", "csv")
    [again] = import_results(tmp_path / "again.csv", tmp_path / "second")
    assert_frame_equal(again.table(), results.table())


texts = st.text(st.characters(codec="utf-8", exclude_characters="\r\n\x00"), max_size=6).map(
    lambda text: text.strip() or None
)
numbers = st.one_of(st.none(), st.floats(0, 1e6))
counts = st.one_of(st.none(), st.integers(0, 2**40))
OPTIONAL = {"string": texts, "float": numbers, "integer": counts}
FREE = {
    column.name: OPTIONAL[column.type]
    for column in COLUMNS[COLUMNS.index(next(c for c in COLUMNS if c.name == "gt_precision@1")) :]
    if column.name not in ("settings_key", "row_key", "machine", "preset")
}


@pytest.mark.slow
@settings(max_examples=20)
@given(values=st.fixed_dictionaries(FREE))
def test_every_other_column_comes_back(
    values: dict[str, Any], tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("any")
    [row] = measured("d", "p", 1)[:1]
    row = row | values
    schema = {name: polars_schema().get(name, pl.String) for name in row}
    export_table(pl.DataFrame([row], schema=schema), folder / "t.csv", "csv")
    [results] = import_results(folder / "t.csv", folder / "results")
    [got] = results.table().to_dicts()
    assert {name: got[name] for name in values} == values


def changed(**values: Any) -> list[dict[str, Any]]:
    """The rows with other values in the second one."""
    rows = measured("flight", "board")
    rows[1] = rows[1] | values
    return rows


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"inliers": -1}, r"-1(\.0)?'? as inliers in row 2"),
        ({"seconds_per_1k_matches": -0.5}, "seconds_per_1k_matches in row 2"),
        ({"inliers": 10.5}, "inliers in row 2"),
        ({"inliers": 1e40}, "inliers in row 2"),
        ({"matches": float("inf")}, "matches in row 2"),
        ({"inliers": 300}, "row 2 .*inliers.*matches"),
        ({"precision": 50.0}, "row 2 .*precision"),
        ({"pair": None}, "row 2 .*pair"),
        ({"pair": 0}, r"rows 1 and 2 .*\(machine board, dataset flight, .*pair 0"),
        ({"dataset": None}, "dataset in row 2"),
        ({"matcher": " "}, "matcher in row 2"),
        ({"detector": "super-point"}, "detector 'SUPER-POINT'"),
    ],
)
@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_wrong_values_are_named(
    tmp_path: Path, suffix: str, values: dict[str, Any], told: str
) -> None:
    rows = changed(**values)
    for row in rows:  # one type a column, as Parquet needs
        row.update({name: float(row[name]) for name in values if type(row[name]) is int})
    file = write_table(tmp_path / f"t.{suffix}", rows)
    with pytest.raises(StoreError, match=told):
        import_results(file, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_text_in_place_of_a_number_is_named(tmp_path: Path) -> None:
    rows = [row | {"precision": "0,5"} for row in measured("flight", "board")]
    with pytest.raises(StoreError, match="'0,5' as precision in row 1"):
        import_results(write_table(tmp_path / "t.csv", rows), tmp_path / "out")


def test_an_unknown_status_is_named(tmp_path: Path) -> None:
    rows = [row | {"status": "fine"} for row in measured("flight", "board")]
    with pytest.raises(StoreError, match=r"row 1 .*\bok,"):
        import_results(write_table(tmp_path / "t.csv", rows), tmp_path / "out")


@pytest.mark.parametrize(
    ("frame", "told"),
    [
        (
            pl.DataFrame(measured("a", "b")).rename({"recall": "recal"}),
            r"\brecal\b.*\brecall\b",
        ),
        (pl.DataFrame(measured("a", "b")).drop("matches", "pair"), "pair, match"),
        (pl.DataFrame(measured("a", "b")).with_columns(more=1), "more"),
        (pl.DataFrame(measured("a", "b")).with_columns(machine=pl.lit("b")), "machine"),
        (
            pl.DataFrame(measured("a", "b")).with_columns(inliers=pl.lit([1, 2], pl.List(pl.Int8))),
            r"List.* inliers",
        ),
        (
            pl.DataFrame(measured("a", "b")).with_columns(inliers=pl.lit(value=True)),
            "Boolean .* inliers",
        ),
        (pl.DataFrame(measured("a", "b")).clear(), "row"),
    ],
)
def test_columns_that_do_not_fit_are_named(tmp_path: Path, frame: pl.DataFrame, told: str) -> None:
    frame.write_parquet(tmp_path / "t.parquet")
    with pytest.raises(StoreError, match=told):
        import_results(tmp_path / "t.parquet", tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("t.csv", b"", "CSV"),
        ("t.csv", b"dataset,pair\n1,2,3\n", "CSV"),
        ("t.csv", b"dataset\n\xff\n", "CSV"),
        ("t.csv", b"dataset;pair\na;1\n", "lacks the columns detector"),
        ("t.csv", b"dataset,pair\n", "row"),
        ("t.parquet", b"PAR1" + b"x" * 50 + b"PAR1", "Parquet"),
        ("t.parquet", b"dataset,pair\n", "CSV nor Parquet"),
        ("t.xlsx", b"PK", "CSV nor Parquet"),
    ],
)
def test_files_that_are_no_tables_are_refused(
    tmp_path: Path, name: str, content: bytes, told: str
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(StoreError, match=told):
        import_results(tmp_path / name, tmp_path / "out")
    with pytest.raises(StoreError, match=r"missing\.csv: No such file"):
        import_results(tmp_path / "missing.csv", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_the_same_import_replaces_itself(table: Path, tmp_path: Path) -> None:
    import_results(table, tmp_path / "out")
    write_table(table, measured("flight", "board", 3))
    [results] = import_results(table, tmp_path / "out")
    assert len(results.table()) == results.status().planned == 6
    assert sorted(path.name for path in (tmp_path / "out" / "parts").iterdir()) == ["all.parquet"]


def test_what_is_in_use_for_something_else_is_refused(table: Path, tmp_path: Path) -> None:
    out, several = tmp_path / "out", tmp_path / "several.csv"
    write_table(several, measured("a", "b") + measured("a", "c"))
    import_results(table, out)
    other = write_table(tmp_path / "other.csv", measured("flight", "desk"))
    with pytest.raises(StoreError, match=r"flight on board.*flight on desk"):
        import_results(other, out)
    with pytest.raises(StoreError, match=r"\b2\b"):
        import_results(several, out)
    (out / "notes.txt").write_text("mine")
    with pytest.raises(StoreError, match=r"notes\.txt"):
        import_results(table, out)
    (tmp_path / "photos" / "trip").mkdir(parents=True)
    with pytest.raises(StoreError, match="trip"):
        import_results(several, tmp_path / "photos")
    with pytest.raises(StoreError, match=r"other\.csv"):
        import_results(table, other)
    assert (out / "notes.txt").read_text() == "mine"
    assert len(Results(out).table()) == 4


def test_measured_rows_are_never_replaced(table: Path, tmp_path: Path) -> None:
    store = Store.create(tmp_path / "run")
    store.write_run({"settings_key": "now"})
    with pytest.raises(StoreError, match=str(store.folder)):
        import_results(table, store.folder)
    (store.folder / "run.json").unlink()
    store.write_rows("one", [])
    with pytest.raises(StoreError, match=str(store.folder)):
        import_results(table, store.folder)


def test_other_results_beside_do_not_matter(tmp_path: Path) -> None:
    several = write_table(tmp_path / "several.csv", measured("a", "b") + measured("a", "c"))
    out = tmp_path / "out"
    for _ in range(2):
        assert len(import_results(several, out)) == 2
        (out / "scores.csv").write_text("mine")
    assert (out / "scores.csv").read_text() == "mine"


@pytest.mark.parametrize("at", [0, 1, 3, 7])
@pytest.mark.parametrize("failure", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_nothing_is_left_half_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failure: BaseException, at: int
) -> None:
    several = write_table(
        tmp_path / "t.csv", measured("a", "b") + measured("a", "c") + measured("d", "c")
    )
    out = tmp_path / "new" / "out"
    calls, write = [], os.fsync

    def fail(descriptor: int) -> None:
        calls.append(descriptor)
        if len(calls) > at:
            raise failure
        write(descriptor)

    monkeypatch.setattr(os, "fsync", fail)
    told = StoreError if isinstance(failure, OSError) else KeyboardInterrupt
    with pytest.raises(told):
        import_results(several, out)
    assert list(tmp_path.iterdir()) == [several]
    monkeypatch.undo()
    import_results(several, out)
    before = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    calls.clear()
    write_table(several, measured("a", "b", 3) + measured("a", "c", 3) + measured("d", "c", 3))
    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(told):
        import_results(several, out)
    assert {path: path.read_bytes() for path in out.rglob("*") if path.is_file()} == before


def test_reconstructions_go_to_the_folders_of_their_dataset(tmp_path: Path) -> None:
    rows = measured("a", "one") + measured("b", "one") + measured("b", "two")
    file = write_table(tmp_path / "t.csv", rows)
    models = write_table(tmp_path / "models.csv", figures("b") + figures("elsewhere"))
    made = import_results(file, tmp_path / "out", reconstruction=models)
    assert [len(results.reconstructions()) for results in made] == [0, 2, 2]
    good, failed = made[1].reconstructions().to_dicts()
    assert good["detector"] == "ORB"
    assert (good["reprojection_error"], good["points_3d"]) == (0.5, 800)
    assert (good["status"], failed["status"]) == ("ok", "error")
    assert failed["message"]
    origin = made[1].settings["imported"]["reconstruction"]
    assert origin["file"] == "models.csv"
    with pytest.raises(StoreError, match=r"models\.csv .*\bb, elsewhere\b"):
        import_results(file, tmp_path / "a", dataset="a", reconstruction=models)
    assert not (tmp_path / "a").exists()


def test_reconstructions_stay_where_there_are_no_others(tmp_path: Path, table: Path) -> None:
    models = write_table(tmp_path / "models.parquet", figures("flight"))
    for reconstruction in (models, None):
        [results] = import_results(table, tmp_path / "out", reconstruction=reconstruction)
        assert len(results.reconstructions()) == 2


def test_wrong_reconstructions_are_named(tmp_path: Path, table: Path) -> None:
    for rows, told in (
        (figures("flight") * 2, r"rows 1 and 3 .*\(dataset flight, detector ORB"),
        ([row | {"more": 1} for row in figures("flight")], "more"),
        ([row | {"points_3d": -2} for row in figures("flight")], "points_3d"),
        ([{"dataset": "flight"}], "detector,.* reprojection_error, points_3d"),
    ):
        models = write_table(tmp_path / "models.csv", rows)
        with pytest.raises(StoreError, match=told):
            import_results(table, tmp_path / "out", reconstruction=models)
        assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_the_published_measurements_are_read(shared_data: Path, tmp_path: Path) -> None:
    published = shared_data / "published"
    made = import_results(
        published / "measurements.parquet",
        tmp_path / "out",
        reconstruction=published / "reconstruction.csv",
    )
    assert sum(len(results.table()) for results in made) == 116_154
    drone = next(results for results in made if results.folder.name == "drone-desktop")
    assert len(drone.reconstructions()) == 422
    run = json.loads((drone.folder / "run.json").read_text())
    assert run["dataset"]["pairs"] == 35


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("recall", "7", "recall"),
        ("f1_score", "88", "f1_score"),
        ("seconds_per_1k_inliers", "inf", "seconds_per_1k_inliers"),
    ],
)
def test_figures_that_cannot_be_are_refused(
    table: Path, tmp_path: Path, name: str, value: str, told: str
) -> None:
    frame = pl.read_csv(table, infer_schema=False).with_columns(pl.lit(value).alias(name))
    frame.write_csv(table)
    with pytest.raises(StoreError, match=told):
        import_results(table, tmp_path / "results")


def test_blank_lines_at_the_end_are_no_rows(table: Path, tmp_path: Path) -> None:
    number = len(pl.read_csv(table))
    blank = "," * table.read_text().splitlines()[0].count(",")
    table.write_text(f"{table.read_text()}{blank}\n\n")
    [results] = import_results(table, tmp_path / "results")
    assert len(results.table()) == number
