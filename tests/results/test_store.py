from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import polars as pl
import pytest

from aerocues.errors import StoreError
from aerocues.results.measured_results import Results
from aerocues.results.plan_table import IDENTITY_NAMES
from aerocues.results.row_files import RowFiles
from aerocues.results.schema import COLUMNS, empty_row, polars_schema
from aerocues.results.store import Store


def row(number: int, **values: Any) -> dict[str, Any]:
    methods = "-".join(values.get(name, "ORB") for name in ("detector", "descriptor"))
    return {
        **empty_row(),
        "dataset": "d",
        "sequence": "s",
        "pair": number,
        "image_1": f"a{number}",
        "image_2": "b",
        "detector": "ORB",
        "descriptor": "ORB",
        "norm": "HAM",
        "matcher": "BF",
        "status": "ok",
        "timing": "shared",
        "settings_key": "now",
        "row_key": f"key-{number}-{methods}",
        "measured_at": 1.0,
        **values,
    }


def planned(rows: list[dict[str, Any]], dataset_key: str = "full size") -> pl.DataFrame:
    """The plan of a run that is to measure `rows`."""
    named = [{name: row[name] for name in (*IDENTITY_NAMES, "row_key")} for row in rows]
    schema = {name: polars_schema()[name] for name in (*IDENTITY_NAMES, "row_key")}
    return pl.DataFrame(named, schema=schema).with_columns(
        pl.lit(rows[0]["settings_key"]).alias("settings_key"),
        pl.lit(dataset_key).alias("dataset_key"),
    )


@pytest.fixture
def store(tmp_path: Path) -> Store:
    """A folder that is to hold the rows of pairs 1 to 9."""
    made = Store.create(tmp_path / "results")
    made.write_plan(planned([row(number) for number in range(1, 10)]))
    made.write_run({"settings_key": "now"})
    return made


def test_rows_come_back_with_their_types(store: Store) -> None:
    values = {"matches": 7, "precision": 0.1 + 0.2, "message": "größe", "gt_precision@3": None}
    store.write_rows("one", [row(1, **values, homography_error=float("inf"))])
    [got] = store.table().to_dicts()
    assert got == row(1, **values, homography_error=float("inf"))
    assert list(got) == [column.name for column in COLUMNS]


def test_rows_come_in_a_fixed_order_whenever_they_were_written(store: Store) -> None:
    other = row(1, detector="AKAZE", row_key="key-1a")
    store.write_plan(planned([other]))
    store.write_rows("z", [row(3), row(1)])
    store.write_rows("a", [row(2), other])
    order = [(r["pair"], r["detector"]) for r in store.table().to_dicts()]
    assert order == [(1, "AKAZE"), (1, "ORB"), (2, "ORB"), (3, "ORB")]


@pytest.mark.parametrize("names", [("a", "b"), ("b", "a")])
def test_the_newest_row_wins(store: Store, names: tuple[str, str]) -> None:
    store.write_rows(names[0], [row(1, matches=4, measured_at=100.0), row(2)])
    store.write_rows(names[1], [row(1, matches=5, measured_at=200.0)])
    got = store.table().to_dicts()
    assert [(r["pair"], r["status"], r["matches"]) for r in got] == [(1, "ok", 5), (2, "ok", None)]


@pytest.mark.parametrize("status", ["crashed", "timeout", "error", "out_of_memory"])
def test_a_failure_never_hides_a_result(store: Store, status: str) -> None:
    store.write_rows("a", [row(1, measured_at=100.0)])
    store.write_rows("b", [row(1, status=status, measured_at=200.0, timing="exclusive")])
    store.write_rows("c", [row(2, status=status, measured_at=100.0)])
    store.write_rows("d", [row(2, measured_at=200.0)])
    assert store.table()["status"].to_list() == ["ok", "ok"]


@pytest.mark.parametrize("exclusive_first", [True, False])
def test_exclusive_times_come_before_shared_ones(store: Store, exclusive_first: bool) -> None:
    times = (100.0, 200.0) if exclusive_first else (200.0, 100.0)
    store.write_rows("a", [row(1, timing="exclusive", match_seconds=1.0, measured_at=times[0])])
    store.write_rows("b", [row(1, timing="shared", match_seconds=2.0, measured_at=times[1])])
    [got] = store.table().to_dicts()
    assert (got["timing"], got["match_seconds"]) == ("exclusive", 1.0)


def test_rows_of_other_settings_are_left_out(store: Store) -> None:
    before = [row(n, settings_key="before", row_key=f"old-{n}", dataset="e") for n in (1, 2)]
    store.write_plan(planned(before))
    store.write_rows("old", before)
    store.write_rows("new", [row(1, matches=2)])
    assert [(r["dataset"], r["pair"]) for r in store.table().to_dicts()] == [("d", 1)]
    store.write_run({"settings_key": "before"})
    table = store.table().to_dicts()
    assert [(r["dataset"], r["pair"]) for r in table] == [("e", 1), ("e", 2)]


def test_a_dataset_read_in_another_way_replaces_itself(store: Store) -> None:
    store.write_rows("wide", [row(1, matches=1), row(2, matches=1)])
    small = row(1, matches=2, row_key="small")
    store.write_plan(planned([small], "500 px wide"))
    store.write_rows("small", [small])
    assert [(r["pair"], r["matches"]) for r in store.table().to_dicts()] == [(1, 2)]
    store.write_plan(planned([row(1), row(2)]))
    assert [(r["pair"], r["matches"]) for r in store.table().to_dicts()] == [(1, 1), (2, 1)]


def test_a_folder_is_filled_part_by_part(store: Store) -> None:
    store.write_plan(planned([row(1, descriptor="BRISK")]))
    more = row(7, image_1="a", image_2="c", row_key="more")
    store.write_plan(planned([more]))
    assert len(store.planned()) == 11


def test_another_pair_with_a_number_that_is_taken_gets_a_free_one(tmp_path: Path) -> None:
    store = Store.create(tmp_path / "results")
    store.write_run({"settings_key": "now"})
    first = [row(0), row(0, descriptor="BRISK"), row(1)]
    store.write_plan(planned(first))
    store.write_rows("first", first)
    second = [row(0, image_1="c", row_key="c"), row(2, image_1="e", row_key="e")]
    store.write_plan(planned(second))
    store.write_rows("second", second)
    assert sorted(store.table().select("pair", "image_1", "descriptor").rows()) == [
        *((0, "c", "ORB"), (1, "a1", "ORB"), (2, "e", "ORB")),
        *((3, "a0", "BRISK"), (3, "a0", "ORB")),
    ]


def test_a_pair_that_got_another_number_is_not_counted_twice(tmp_path: Path) -> None:
    store = Store.create(tmp_path / "results")
    store.write_run({"settings_key": "now"})
    store.write_plan(planned([row(0), row(0, descriptor="BRISK")]))
    moved = row(5, image_1="a0", row_key=row(0)["row_key"])
    store.write_plan(planned([moved]))
    store.write_rows("a", [row(0, matches=4), row(0, descriptor="BRISK", matches=6)])
    got = store.table().select("pair", "descriptor", "matches").rows()
    assert got == [(5, "BRISK", 6), (5, "ORB", 4)]


def test_one_run_at_a_time_writes(store: Store) -> None:
    with store.writing(), pytest.raises(StoreError, match="another run"):
        Store.create(store.folder).writing().__enter__()
    with Store.create(store.folder).writing():
        store.write_rows("one", [row(1)])


def test_a_missing_plan_is_an_error_with_the_next_step(store: Store) -> None:
    store.write_rows("one", [row(1)])
    (store.folder / "plan.parquet").unlink()
    with pytest.raises(StoreError, match=r"plan\.parquet"):
        store.table()


def test_what_is_present_need_not_be_measured_again(store: Store) -> None:
    store.write_rows("a", [row(1), row(2, status="chance"), row(3, timing="exclusive")])
    failed = ("error", "crashed", "timeout", "out_of_memory")
    store.write_rows("b", [row(4 + i, status=status) for i, status in enumerate(failed)])
    everything = {f"key-{i}-ORB-ORB" for i in range(1, 8)}
    assert store.present("shared", retry_failed=False) == everything
    again = {"key-1-ORB-ORB", "key-2-ORB-ORB"}
    assert store.present("exclusive", retry_failed=False) == everything - again
    assert store.present("exclusive", retry_failed=True) == {"key-3-ORB-ORB"}
    assert store.present("shared", retry_failed=True) == {f"key-{i}-ORB-ORB" for i in (1, 2, 3)}


def test_an_empty_folder_has_an_empty_table(store: Store) -> None:
    assert store.table().shape == (0, len(COLUMNS))
    assert store.present("shared", retry_failed=False) == frozenset()


def test_leftovers_of_an_interrupted_writing_are_removed(store: Store) -> None:
    store.write_rows("kept", [row(1)])
    for path in ("parts/x.parquet.77.tmp", "run.json.77.tmp"):
        (store.folder / path).write_bytes(b"half")
    assert len(store.table()) == 1
    again = Store.create(store.folder)
    with again.writing():
        assert not list(store.folder.rglob("*.tmp"))
    assert len(again.table()) == 1


def test_writing_leaves_nothing_beside(store: Store) -> None:
    store.write_rows("one", [row(1)])
    names = {path.name for path in store.folder.rglob("*") if path.is_file()}
    assert names == {"one.parquet", "run.json", "plan.parquet"}


def test_a_failed_writing_leaves_the_old_part(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    store.write_rows("one", [row(1, matches=1)])

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(StoreError, match="No space left on device"):
        store.write_rows("one", [row(1, matches=2)])
    assert not list(store.folder.rglob("*.tmp"))
    assert store.table()["matches"].to_list() == [1]


@pytest.mark.parametrize("content", ["", "{", "[1, 2]", "\x00"])
def test_a_damaged_record_of_the_run_is_an_error_with_the_next_step(
    store: Store, content: str
) -> None:
    (store.folder / "run.json").write_text(content)
    with pytest.raises(StoreError, match=r"run\.json"):
        Store.open(store.folder).run()


def test_a_damaged_record_is_restored_by_the_next_run(store: Store) -> None:
    store.write_rows("one", [row(1)])
    (store.folder / "run.json").write_text("{")
    again = Store.create(store.folder)
    again.write_run({"settings_key": "now"})
    assert len(again.table()) == 1


def test_folders_that_are_no_results_are_refused(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match=str(tmp_path)):
        Store.open(tmp_path)
    with pytest.raises(StoreError, match="missing"):
        Results(tmp_path / "missing")
    (tmp_path / "file").write_text("x")
    with pytest.raises(StoreError, match="file"):
        Store.create(tmp_path / "file")
    with pytest.raises(StoreError, match="file"):
        Store.create(tmp_path / "file" / "below")
    with pytest.raises(StoreError, match="file"):
        Store.create(tmp_path)


def test_the_record_of_the_run_is_readable_json(store: Store) -> None:
    store.write_run({"settings_key": "now", "path": Path("a"), "values": (1, 2)})
    content = json.loads((store.folder / "run.json").read_text())
    assert len(content.pop("checksum")) == 32
    assert content == {"settings_key": "now", "path": "a", "values": [1, 2]}


def test_status_counts_what_is_done_left_and_failed(store: Store) -> None:
    store.write_plan(planned([row(3, descriptor="BRISK"), row(10)]))
    store.write_rows(
        "a",
        [
            row(1),
            row(2, status="error", message="why"),
            row(3, status="error", message="why too", descriptor="BRISK"),
            row(4, status="error", message="again"),
            row(5, status="chance"),
        ],
    )
    status = Results(store.folder).status()
    assert (status.planned, status.done, status.left) == (11, 5, 6)
    assert status.statuses == {"error": 3, "chance": 1, "ok": 1}
    failures = {(f["status"], f["descriptor"]): f["rows"] for f in status.failures.to_dicts()}
    assert failures == {("chance", "ORB"): 1, ("error", "ORB"): 2, ("error", "BRISK"): 1}


def test_sql_answers_and_explains_itself(store: Store) -> None:
    store.write_rows("a", [row(1, matches=4), row(2, matches=6)])
    results = Results(store.folder)
    assert results.sql("SELECT sum(matches) AS total FROM results").to_dicts() == [{"total": 10}]
    for query, told in (
        ("SELEC", "SELECT or WITH"),
        ("SELECT nothing FROM results", "nothing"),
        ("SELECT * FROM rows", "results and reconstructions"),
    ):
        with pytest.raises(StoreError, match=told):
            results.sql(query)


@pytest.mark.parametrize(
    "source",
    [
        "read_csv('{file}')",
        "READ_CSV ('{file}')",
        "read_csv/* */('{file}')",
        "\"read_csv\"('{file}')",
        "(SELECT \"--\", * FROM read_csv('{file}'))",
        "results WHERE detector IN (SELECT secret FROM read_csv('{file}'))",
    ],
)
def test_sql_sees_no_files(store: Store, tmp_path: Path, source: str) -> None:
    store.write_rows("a", [row(1)])
    (tmp_path / "other.csv").write_text("secret\nORB\n")
    with pytest.raises(StoreError, match="no files"):
        Results(store.folder).sql(f"SELECT * FROM {source.format(file=tmp_path / 'other.csv')}")
    told = Results(store.folder).sql("SELECT 'read_csv(x)' AS text FROM results -- read_csv(x)")
    assert told.to_dicts() == [{"text": "read_csv(x)"}]


def write_many(store: Store, count: int) -> list[dict[str, Any]]:
    """A file for each of so many rows."""
    rows = [row(n, matches=n, measured_at=float(n)) for n in range(count)]
    store.write_plan(planned(rows))
    for each in rows:
        store.write_rows(f"{each['pair']:05d}", [each])
    return rows


def test_very_many_small_files_are_put_together(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("aerocues.results.row_files.MANY_FILES", 10)
    rows = write_many(store, 25)
    before = store.table()
    with store.writing():
        assert len(store.parts()) == 7  # two of ten rows, and five that are not enough
        store.write_rows("again", [row(3, matches=99, measured_at=99.0)])
    assert (
        store.table().drop("matches", "measured_at").equals(before.drop("matches", "measured_at"))
    )
    assert dict(store.table().select("pair", "matches").iter_rows())[3] == 99
    assert store.present("shared", retry_failed=False) == {each["row_key"] for each in rows}
    with store.writing():
        for number in range(4):
            store.write_rows(f"more-{number}", [row(number, matches=100, measured_at=100.0)])
    assert len(store.parts()) == 3
    assert store.table()["matches"].to_list() == [100] * 4 + list(range(4, 25))


def test_files_that_are_put_together_meanwhile_are_read_all_the_same(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("aerocues.results.row_files.MANY_FILES", 10)
    write_many(store, 20)
    expected = store.table()
    listed = RowFiles.files
    stale = listed(RowFiles(store.folder / "parts"))
    with Store.create(store.folder).writing():
        pass
    answers = [stale]  # what was there before the other process began
    monkeypatch.setattr(RowFiles, "files", lambda self: answers.pop() if answers else listed(self))
    assert store.table().equals(expected)


def test_an_interrupted_putting_together_loses_and_doubles_nothing(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("aerocues.results.row_files.MANY_FILES", 10)
    write_many(store, 20)
    expected = store.table()

    def interrupted(self: Path, **_: object) -> None:
        if self.suffix == ".parquet":
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Path, "unlink", interrupted)
        with pytest.raises(KeyboardInterrupt):
            store.writing().__enter__()
    assert len(store.parts()) == 21
    assert store.table().equals(expected)
    with store.writing():
        assert len(store.parts()) == 2
    assert store.table().equals(expected)
