"""`aerocues status`: done, left, failed and left out."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import polars as pl

from aerocues.results.measured_results import Results
from tests.cli.conftest import Call


def test_a_finished_run_has_nothing_left(call: Call, finished: Path) -> None:
    answer = call("status", finished)
    assert answer.code == 0
    assert answer.out.startswith("12 of 12 rows done, none left\n")
    assert re.search(r"ok +\d+", answer.out)


def test_what_failed_is_listed_by_reason_and_methods(call: Call, finished: Path) -> None:
    facts = json.loads(call("status", finished, "--json").out)
    counts = Results(finished).table()["status"].value_counts()
    assert facts["planned"] == facts["done"] == 12
    assert facts["left"] == 0
    assert facts["statuses"] == dict(counts.iter_rows())
    failed = {(row["detector"], row["descriptor"]): row for row in facts["failures"]}
    # FREAK's pattern at the sizes of ORB's keypoints is larger than these images.
    assert failed["ORB", "FREAK"]["status"] == "no_descriptors"
    assert failed["ORB", "FREAK"]["rows"] == 3
    assert re.search(r"no_descriptors +3 +ORB-FREAK", call("status", finished).out)


def test_what_is_left_and_left_out_is_told(call: Call, finished: Path, tmp_path: Path) -> None:
    folder = tmp_path / "half"
    shutil.copytree(finished, folder)
    part = min((folder / "parts").glob("*.parquet"))
    lost = len(pl.read_parquet(part))
    part.unlink()
    run = json.loads((folder / "run.json").read_text())
    run["exclusions"] = [{"combination": "ORB-LUCID-HAM-BF", "reason": "gray", "pairs": 3}]
    (folder / "run.json").write_text(json.dumps(run))
    answer = call("status", folder)
    assert answer.out.startswith(f"{12 - lost} of 12 rows done, {lost} left")
    assert "ORB-LUCID-HAM-BF on 3 pairs: gray" in answer.out


def test_every_file_is_verified(call: Call, finished: Path, tmp_path: Path) -> None:
    folder = tmp_path / "damaged"
    shutil.copytree(finished, folder)
    answer = call("status", folder, "--verify")
    assert (answer.code, answer.err) == (0, "")
    assert re.fullmatch(r"\d+ files checked, none damaged\n", answer.out)
    part = min((folder / "parts").glob("*.parquet"))
    lost = len(pl.read_parquet(part))
    part.write_bytes(part.read_bytes()[:-1])
    answer = call("status", folder, "--verify")
    assert answer.code == 1
    assert answer.out.startswith(f"{part} is damaged (")
    [told] = json.loads(call("status", folder, "--verify", "--json").out)["damaged"]
    assert told["file"] == str(part)
    answer = call("status", folder)
    assert answer.code == 0
    assert answer.out.startswith(f"{12 - lost} of 12 rows done")
    [line] = answer.err.splitlines()
    assert line.startswith(f"warning: {part} is damaged")
    assert "'aerocues run' measures them again" in line


def test_what_was_left_out_for_one_reason_takes_one_line(
    call: Call, finished: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "gray"
    shutil.copytree(finished, folder)
    run = json.loads((folder / "run.json").read_text())
    left_out = [
        (f"{detector}-LUCID-HAM-{matcher}", "gray", pairs)
        for detector in ("ORB", "SIFT")
        for matcher in ("BF", "FLANN")
        for pairs in (5, 1)
    ]
    mixed = ["ORB-SIFT-L2-BF", "SIFT-ORB-HAM-BF", "KAZE-KAZE-L2-BF", "MSD-VGG-L2-BF"]
    left_out += [(name, "odd", 2) for name in mixed]
    run["exclusions"] = [
        {"combination": name, "reason": reason, "pairs": pairs} for name, reason, pairs in left_out
    ]
    (folder / "run.json").write_text(json.dumps(run))
    lines = call("status", folder).out.splitlines()
    assert lines[-3:] == [
        "  4 combinations with LUCID on 5 pairs: gray",
        "  4 combinations with LUCID on 1 pair: gray",
        "  4 combinations (ORB-SIFT-L2-BF, SIFT-ORB-HAM-BF, KAZE-KAZE-L2-BF, ...) on 2 pairs: odd",
    ]
    facts = json.loads(call("status", folder, "--json").out)
    assert facts["exclusions"] == run["exclusions"]


def test_what_is_left_of_a_packed_folder_needs_the_folder(
    call: Call, finished: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "half"
    shutil.copytree(finished, folder)
    min((folder / "parts").glob("*.parquet")).unlink()
    Results(folder).pack(tmp_path / "half.zip")
    assert "unzip" in call("status", tmp_path / "half.zip").out
    assert "unzip" not in call("status", folder).out


def test_a_folder_without_results_is_refused(call: Call, tmp_path: Path) -> None:
    for folder in (tmp_path, tmp_path / "missing"):
        answer = call("status", folder)
        assert answer.code == 2
        assert re.fullmatch(rf"error: .*{folder}.*\n", answer.err)


def test_what_is_left_to_be_timed_alone_is_told(call: Call, finished: Path, tmp_path: Path) -> None:
    folder = tmp_path / "untimed"
    shutil.copytree(finished, folder)
    plan = pl.read_parquet(folder / "plan.parquet")
    plan.with_columns(timed_alone=pl.col("pair") == 0).write_parquet(folder / "plan.parquet")
    for part in (folder / "parts").glob("*.parquet"):
        pl.read_parquet(part).with_columns(timing=pl.lit("estimated")).write_parquet(part)
    answer = call("status", folder)
    assert re.match(r"12 of 12 rows done, none left; 4 .* timed alone", answer.out)
    assert json.loads(call("status", folder, "--json").out)["untimed"] == 4
