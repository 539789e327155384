"""`aerocues run`: measuring, going on, planning, refusing."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

import pytest

import aerocues
from tests.cli.conftest import COMBINATIONS, Call


@pytest.mark.slow
def test_a_run_ends_with_the_best_and_what_to_do_next(
    call: Call, photos: Path, tmp_path: Path
) -> None:
    output = tmp_path / "my results"
    words = ("run", photos, "-o", output, "--combinations", "ORB-ORB-HAM-BF", "--workers", 1)
    first = call(*words, "--max-pairs", 2)
    assert first.code == 0
    assert re.search(r"1 ORB-ORB-HAM-BF +[01]\.\d{3} .* 100 % +[01]\.\d{3} +\d+ ", first.out)
    assert "photos: 1 combination on 2 pairs" in first.out
    assert re.search(r"rows +2: ok 2\ntimes +exclusive 2\b", first.out)
    assert f"aerocues status '{output}'" in first.out
    assert f"aerocues score '{output}'" in first.out
    assert "timed 2 alone" in first.err

    second = call(*words, "--max-pairs", 2)
    assert "all 2 rows" in second.err
    assert second.out == first.out

    more = call(*words)
    assert re.search(r"^1 row .* 2 rows", more.err, re.MULTILINE)
    assert "on 3 pairs" in more.out


def test_the_table_ranks_by_cues_and_fits_100_columns(
    call: Call, photos: Path, finished: Path
) -> None:
    words = ("run", photos, "-o", finished, "--combinations", COMBINATIONS, "--workers", 1)
    answer = call(*words, "--top", 2)
    assert answer.code == 0
    table = answer.out.split("\n\n", maxsplit=1)[0].splitlines()
    assert table[0] == "photos: best 2 of 4 combinations on 3 pairs"
    assert max(map(len, table)) <= 100
    assert table[2].split()[-2:] == ["a", "pair"]
    ranked = [line.split()[:3] for line in table[3:5]]
    scores = {row["combination"]: row["score"] for row in _ranking(finished)}
    assert [words[0] for words in ranked] == ["1", "2"]
    assert {name: float(score) for _, name, score in ranked} == pytest.approx(
        dict(list(scores.items())[:2]), abs=5e-4
    )


def _ranking(folder: Path) -> list[dict[str, Any]]:
    return aerocues.score(aerocues.Results(folder)).frame("combination").to_dicts()


def test_a_run_in_which_all_fails_says_why_there_is_no_ranking(call: Call, tmp_path: Path) -> None:
    from PIL import Image

    for name in ("a", "b"):
        (tmp_path / "blank").mkdir(exist_ok=True)
        Image.new("RGB", (160, 120), "gray").save(tmp_path / "blank" / f"{name}.png")
    words = ("run", tmp_path / "blank", "-o", tmp_path / "results", "--workers", 1)
    answer = call(*words, "--combinations", "ORB-ORB-HAM-BF,AKAZE-AKAZE-HAM-BF")
    assert answer.code == 0
    assert answer.out.startswith("no ranking: ")
    assert "rows     2: no_keypoints 2" in answer.out
    assert "aerocues status" in answer.out
    assert "aerocues report" not in answer.out


def test_a_dry_run_shows_the_plan_and_writes_nothing(
    call: Call, photos: Path, tmp_path: Path
) -> None:
    output = tmp_path / "results"
    answer = call("run", photos, "-o", output, "--detectors", "orb", "--dry-run")
    assert answer.code == 0
    assert "photos: 4 images, 3 pairs" in answer.out
    assert re.search(r"combinations +24 of the 56\b", answer.out)
    assert re.search(r"\b8 left out: ", answer.out)
    assert re.search(r"rows +72\b.* 0\b", answer.out)
    assert re.search(r"timed alone +72 rows in 3 units", answer.out)
    assert not output.exists()


def test_a_dry_run_knows_what_is_there(call: Call, photos: Path, finished: Path) -> None:
    words = ("run", photos, "-o", finished, "--combinations", f"{COMBINATIONS},ORB-ORB-HAM-FLANN")
    answer = call(*words, "--dry-run")
    assert re.search(r"rows +15\b.* 12\b", answer.out)


def gray_copy(photos: Path, folder: Path) -> Path:
    from PIL import Image

    folder.mkdir()
    for path in photos.iterdir():
        Image.open(path).convert("L").save(folder / path.name)
    return folder


@pytest.mark.slow
def test_a_run_tells_what_gray_images_rule_out(call: Call, photos: Path, tmp_path: Path) -> None:
    gray = gray_copy(photos, tmp_path / "gray")
    words = ("run", gray, "-o", tmp_path / "results", "--workers", 1, "--max-pairs", 2)
    told = "left out: 2 combinations on 2 pairs"

    alone = call(*words, "--combinations", "ORB-LUCID-HAM-*")
    assert alone.code == 0
    assert told in alone.err
    assert "already" not in alone.err
    assert re.search(r"rows +0: none", alone.out)

    mixed = (*words, "--combinations", "ORB-LUCID-HAM-*,ORB-ORB-HAM-BF")
    for outcome in ("timed 2 alone", "all 2 rows"):
        answer = call(*mixed)
        assert answer.code == 0
        assert told in answer.err
        assert outcome in answer.err


@pytest.mark.slow
def test_an_empty_file_among_the_images_is_an_error_of_its_pairs(
    call: Call, photos: Path, tmp_path: Path
) -> None:
    images = tmp_path / "images"
    shutil.copytree(photos, images)
    (images / "1.png").write_bytes(b"")
    words = ("run", images, "-o", tmp_path / "results", "--workers", 1)
    answer = call(*words, "--combinations", "ORB-ORB-HAM-BF")
    assert answer.code == 0
    assert re.search(r"rows +3: error 2, ok 1", answer.out)


def test_a_dry_run_tells_what_gray_images_rule_out(
    call: Call, photos: Path, tmp_path: Path
) -> None:
    gray = gray_copy(photos, tmp_path / "gray")
    words = ("run", gray, "-o", tmp_path / "results", "--dry-run")
    answer = call(*words, "--combinations", "ORB-LUCID-HAM-BF,ORB-ORB-HAM-BF")
    assert "ORB-LUCID-HAM-BF on 3 pairs" in answer.out


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--combinations", "SIFT-ORB-HAM-BF"), "SIFT-ORB-HAM-BF"),
        (("--combinations", "ORB-SOFT-HAM-BF"), "ORB-SIFT"),
        (("--preset", "nothing"), "'nothing'"),
        (("--equalize", "most"), "most"),
        (("--pairs", "missing.txt"), "missing.txt"),
        (("--sequences", "no*"), "no*"),
        (("--timing", "late"), "'late'"),
        (("--workers", "0"), "--workers"),
        (("--timing-pairs", "-1"), "--timing-pairs"),
        (("--timing", "shared", "--timing-pairs", "3"), "--timing-pairs"),
        (("--timing", "estimated", "--timing-pairs", "5"), "--timing estimated"),
        (("--memory-limit", "0.1"), "0.5"),
        (("--max-width", "8"), "--max-width"),
        (("--max-width", "-1"), "--max-width"),
        (("--max-keypoints", "none"), "--max-keypoints"),
        (("--combinations", "ORB"), "'ORB-*'"),
        (("--combinations", "FREAK"), "'*-FREAK-*'"),
        (("--combinations", "sift-sift"), "'SIFT-SIFT-*'"),
        (("--timeout", "0"), "timeout"),
        (("--max-pairs", "none"), "--max-pairs"),
    ],
)
def test_mistakes_are_told_in_one_line(
    call: Call, photos: Path, tmp_path: Path, words: tuple[str, ...], told: str
) -> None:
    answer = call("run", photos, "-o", tmp_path / "results", *words)
    assert answer.code == 2
    assert answer.out == ""
    assert answer.err.startswith("error: ")
    assert answer.err.count("\n") == 1
    assert told in answer.err
    assert not (tmp_path / "results").exists()


def test_an_unknown_dataset_is_told_with_the_kinds_there_are(call: Call, tmp_path: Path) -> None:
    answer = call("run", "oxfrod:somewhere", "-o", tmp_path / "results")
    assert answer.code == 2
    assert "oxford" in answer.err
    assert answer.err.count("\n") == 1


def test_results_do_not_go_into_a_file_or_where_nobody_may_write(
    call: Call, photos: Path, tmp_path: Path
) -> None:
    file = tmp_path / "file"
    file.write_text("mine")
    words = ("--combinations", "ORB-ORB-HAM-BF")
    answer = call("run", photos, "-o", file, *words)
    assert (answer.code, file.read_text()) == (2, "mine")
    assert str(file) in answer.err
    if Path("/proc/self").exists():
        answer = call("run", photos, "-o", "/proc/self/results", *words)
        assert answer.code == 2
        assert re.fullmatch(r"error: .*/proc/self/results.*\n", answer.err)
