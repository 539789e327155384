"""`aerocues results`: a summary, a query, files."""

from __future__ import annotations

import io
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import polars as pl
import pytest
from polars.testing import assert_frame_equal

from aerocues.results.measured_results import Results
from aerocues.results.schema import COLUMNS
from tests.cli.conftest import Call


def test_without_an_option_there_is_a_summary(call: Call, finished: Path) -> None:
    answer = call("results", finished)
    assert answer.code == 0
    assert "4 combinations on 3 pairs" in answer.out
    assert "preset default" in answer.out
    assert "--columns" in answer.out
    assert "repeatability_beyond_chance" not in answer.out


def test_columns_are_listed_with_what_they_mean(call: Call, finished: Path) -> None:
    answer = call("results", finished, "--columns")
    assert answer.code == 0
    words = answer.out.split()
    assert [column.name for column in COLUMNS if column.name not in words] == []
    assert COLUMNS[0].definition in answer.out
    assert max(map(len, answer.out.splitlines())) <= 100
    assert call("results", finished, "--columns", "--json").code == 2


def test_a_query_is_answered_as_a_table(call: Call, finished: Path) -> None:
    query = "select detector, count(*) as n from results group by detector order by n, detector"
    answer = call("results", finished, "--sql", query)
    assert [line.split() for line in answer.out.splitlines()] == [
        ["detector", "n"],
        ["AKAZE", "3"],
        ["GFTT", "3"],
        ["ORB", "6"],
    ]


@pytest.mark.parametrize(
    "query", ["nonsense", "", "select nothing from results", "select * from elsewhere"]
)
def test_a_wrong_query_is_told_in_one_line(call: Call, finished: Path, query: str) -> None:
    answer = call("results", finished, "--sql", query)
    assert answer.code == 2
    assert answer.err.startswith("error: ")
    assert answer.err.count("\n") == 1


@pytest.mark.parametrize(
    ("query", "told"),
    [
        ("DROP TABLE results", "SELECT"),
        ("-- SELECT\nTRUNCATE results", "SELECT"),
        ("WITH r AS (SELECT 1) DELETE FROM results", "query"),
        ("SELECT inlier FROM results", "inliers"),
        ("SELECT r.inlier FROM results AS r", "inliers"),
        ("SELECT foo FROM results", "'aerocues results RESULTS --columns'"),
        ("SELECT inliers + detector FROM results", "dtypes"),
    ],
)
def test_a_query_that_does_not_read_is_told_shortly(
    call: Call, finished: Path, query: str, told: str
) -> None:
    answer = call("results", finished, "--sql", query)
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("error: ")
    assert told in answer.err
    assert len(answer.err) < 320
    assert answer.err.count("\n") == 1


@pytest.mark.parametrize(
    "query",
    [
        "with r as (select * from results) select count(*) as n from r",
        "-- how many\n(SELECT count(*) AS n FROM results)",
    ],
)
def test_a_query_may_begin_in_other_ways(call: Call, finished: Path, query: str) -> None:
    assert call("results", finished, "--sql", query).out.split() == ["n", "12"]


def test_csv_holds_every_row_and_column(call: Call, finished: Path, tmp_path: Path) -> None:
    file = tmp_path / "rows.csv"
    file.write_text("an older file")
    answer = call("results", finished, "--csv", file)
    assert answer.code == 0
    assert "12 rows" in answer.err
    table = Results(finished).table()
    read = pl.read_csv(file, schema=table.schema)
    assert_frame_equal(read, table)
    assert list(tmp_path.iterdir()) == [file]
    assert call("results", finished, "--csv", "-").out == file.read_text()


def test_parquet_holds_every_row_and_column(call: Call, finished: Path, tmp_path: Path) -> None:
    file = tmp_path / "rows.parquet"
    assert call("results", finished, "--parquet", file).code == 0
    assert_frame_equal(pl.read_parquet(file), Results(finished).table())


def test_parquet_goes_through_a_pipe(finished: Path) -> None:
    command = [sys.executable, "-m", "aerocues", "results", str(finished), "--parquet", "-"]
    piped = subprocess.run(command, capture_output=True, check=True)
    assert_frame_equal(pl.read_parquet(io.BytesIO(piped.stdout)), Results(finished).table())


def test_json_is_a_list_of_rows(call: Call, finished: Path) -> None:
    rows = json.loads(call("results", finished, "--json").out)
    assert len(rows) == 12
    assert list(rows[0]) == [column.name for column in COLUMNS]


def test_a_query_can_be_written_to_a_file(call: Call, finished: Path, tmp_path: Path) -> None:
    file = tmp_path / "answer.csv"
    query = "select detector from results where pair = 0"
    assert call("results", finished, "--sql", query, "--csv", file).code == 0
    assert sorted(file.read_text().split()) == ["AKAZE", "GFTT", "ORB", "ORB", "detector"]


def test_what_cannot_be_written_is_told(call: Call, finished: Path, tmp_path: Path) -> None:
    for file in (tmp_path, tmp_path / "missing" / "rows.csv", "/proc/self/rows.csv"):
        answer = call("results", finished, "--csv", file)
        assert answer.code == 2
        assert answer.err.startswith("error: ")
        assert str(file) in answer.err
        assert answer.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_two_forms_at_once_are_refused(call: Call, finished: Path) -> None:
    answer = call("results", finished, "--csv", "-", "--json")
    assert answer.code == 2
    assert {"--csv", "--json"} <= set(re.findall(r"--\w+", answer.err))


def test_what_csv_cannot_hold_is_told_with_the_form_that_can(
    call: Call, finished: Path, tmp_path: Path
) -> None:
    query = "select detector, array_agg(matches) as matches from results group by detector"
    for target in ("-", tmp_path / "rows.csv"):
        answer = call("results", finished, "--sql", query, "--csv", target)
        assert answer.code == 2
        assert answer.out == ""
        assert re.fullmatch(r"error: .*--parquet or --json\n", answer.err)
    assert list(tmp_path.iterdir()) == []
    for form in ("--parquet", "--csv"):
        assert call("results", finished, form, tmp_path / "rows").code == 0
    assert len(json.loads(call("results", finished, "--sql", query, "--json").out)) == 3


@pytest.mark.slow
def test_pairs_are_counted_by_their_images(call: Call, photos: Path, tmp_path: Path) -> None:
    words = ("-o", tmp_path / "results", "--combinations", "ORB-ORB-HAM-BF", "--workers", 1)
    file = tmp_path / "pairs.txt"
    for pair in ("0.png 1.png", "1.png 2.png"):
        file.write_text(pair)
        answer = call("run", photos, *words, "--pairs", file)
        assert answer.code == 0, answer.err
    assert "1 combination on 2 pairs" in call("results", tmp_path / "results").out
    scored = call("score", tmp_path / "results")
    assert scored.code == 0, scored.err


def test_a_query_is_typeset(call: Call, finished: Path, tmp_path: Path) -> None:
    query = "select 'GFTT_H' as detector, count(*) as n, avg(precision) / 1000 as x from results"
    answer = call("results", finished, "--sql", query, "--markdown", "-")
    assert answer.out.splitlines()[:2] == ["| detector | n | x |", "| --- | ---: | ---: |"]
    file = tmp_path / "table.tex"
    assert call("results", finished, "--sql", query, "--latex", file).code == 0
    assert r"GFTT\_H & 12 & " in file.read_text()


def test_a_folder_is_packed_and_read_where_it_is(
    call: Call, finished: Path, tmp_path: Path
) -> None:
    file = tmp_path / "packed.zip"
    answer = call("results", finished, "--pack", file)
    assert (answer.code, answer.out) == (0, "")
    assert re.fullmatch(rf"12 rows .*{file}.*\n", answer.err)
    assert call("results", file, "--csv", "-") == call("results", finished, "--csv", "-")
    assert call("status", file) == call("status", finished)
    assert call("results", file).out == call("results", finished).out


def test_what_cannot_be_packed_is_told(call: Call, finished: Path, tmp_path: Path) -> None:
    for words, told in (
        (("--pack", tmp_path / "p.zip", "--csv", "-"), "--pack"),
        (("--pack", "-"), "pack"),
        (("--pack", tmp_path), str(tmp_path)),
    ):
        answer = call("results", finished, *words)
        assert answer.code == 2
        assert re.fullmatch(rf"error: .*{told}.*\n", answer.err)
    (tmp_path / "rows.csv").write_text("a,b\n1,2\n")
    for command in ("results", "status"):
        answer = call(command, tmp_path / "rows.csv")
        assert answer.code == 2
        assert re.fullmatch(r"error: .*aerocues import.*\n", answer.err)
    assert [path.name for path in tmp_path.iterdir()] == ["rows.csv"]


def test_of_a_folder_of_results_one_is_to_be_named(
    call: Call, finished: Path, tmp_path: Path
) -> None:
    for name in ("one", "two"):
        shutil.copytree(finished, tmp_path / name)
    for command in ("results", "status"):
        answer = call(command, tmp_path)
        assert answer.code == 2
        assert re.fullmatch(r"error: .*one, two\n", answer.err)
