"""The page of the study: every number is what the database says, and its commands run."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path
from typing import Any

import polars as pl
import pytest

import aerocues
from aerocues.cli.recommendation import STUDIED_AGREEMENT, STUDIED_PLACE
from aerocues.errors import AerocuesError
from aerocues.results.combination_columns import COMBINATION
from aerocues.results.model_quality import MODEL_QUALITY
from aerocues.results.packing import folder_content
from aerocues.results.plan_table import plan_of
from aerocues.results.schema import empty_row, polars_schema
from aerocues.results.study import add_part
from docs.study import PAGES, Findings, rendered
from docs.study_losses import kept_by, others_told
from docs.study_models import COLMAP_DEFAULT, Built
from docs.study_parts import DATABASE, NOT_YET
from docs.study_published import (
    PAIRS,
    PLACES,
    PUBLISHED,
    both_measured,
    lost,
    published_pairs,
)
from docs.study_queries import QUERIES, console, in_common
from tests.cli.conftest import Call
from tests.made_once import made_once
from tests.test_documentation import REPOSITORY, blocks

PAGE = REPOSITORY / "docs" / "study.md"
NAMES = ("brighton-flown-tuned", "uav-thesis", "uav-tuned", "uav-learned", "mini-1000", "mini-4000")

NO_TRUTH = ("position_rmse", "surface_error")
FINISHED = {"leaders": {"finished": "all"}}
NEED_MORE = (
    *("binary", "extra", "flann", "models", "models-finding", "oblique", "predictors", "presets"),
    *("reached", "stale-keypoints", "turned"),
)
"""Statements for which the few rows of the tests do not suffice."""


@pytest.fixture(scope="module")
def findings() -> Findings:
    """What the database of the checkout says."""
    return Findings()


@pytest.fixture(scope="module")
def stand_in(finished: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A database in which all parts hold the same few rows."""

    def make(folder: Path) -> None:
        for name in NAMES:
            facts = {"title": name, "licence": "ours", "cpu_hours": 0.01, "steps": FINISHED}
            add_part(folder / "database", name, finished, facts)

    return made_once(tmp_path_factory, "stand-in-study", make)[0] / "database"


@pytest.fixture(scope="module")
def said(stand_in: Path) -> Findings:
    """What that database says."""
    return Findings(stand_in)


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES)
def test_numbers_follow_the_database(page: str, findings: Findings) -> None:
    text = (REPOSITORY / page).read_text(encoding="utf-8")
    assert text == rendered(page, findings), "out of date; run: make tables"


@pytest.mark.slow
def test_what_recommend_says_of_widths_follows_the_database(findings: Findings) -> None:
    told = findings.pixels()
    place, number = STUDIED_PLACE.split(" of ")
    assert f"have a correlation of {STUDIED_AGREEMENT} ({number} combinations)" in told
    assert f"has place {place} at" in told


@pytest.mark.parametrize("page", PAGES)
def test_every_mark_is_written_by_the_script(page: str) -> None:
    marks = re.findall(r"<!-- (?!end of)([a-z-]+) -->", (REPOSITORY / page).read_text("utf-8"))
    assert sorted(marks) == sorted(PAGES[page])


@pytest.mark.parametrize("name", sorted({name for names in PAGES.values() for name in names}))
def test_each_statement_is_made_of_rows_that_are_there(
    name: str, said: Findings, tmp_path: Path
) -> None:
    filled = getattr(said, name.replace("-", "_"))()
    without_rows = getattr(Findings(tmp_path), name.replace("-", "_"))()
    assert not re.search(r"\bnan\b", filled.lower())
    if name == "dictionary":
        assert filled == without_rows
        return
    assert NOT_YET in without_rows
    if name not in NEED_MORE:
        assert filled != without_rows


def test_presets_are_compared_by_the_truth_on_what_both_measured() -> None:
    """By hand: pairs 0 and 1 are in both and have a known truth; on 1 the first failed."""

    def rows(matches: list[int], shares: list[float | None]) -> pl.DataFrame:
        names = {"detector": "ORB", "descriptor": "ORB", "norm": "HAM", "matcher": "BF"}
        status = ["chance" if number == 11 else "ok" for number in matches]
        figures = {"pair": range(len(matches)), "matches": matches, "gt_precision@3": shares}
        return pl.DataFrame(figures).with_columns(
            pl.Series("status", status), **{k: pl.lit(v) for k, v in names.items()}
        )

    thesis, tuned = rows([4000, 11, 10], [0.5, 0.9, 1.0]), rows([1000, 10], [0.75, 1.0])
    assert in_common(thesis, tuned) == ("1", "1,000", "380", "0.25", "0.88")
    assert in_common(rows([4000], [None]), rows([5], [None])) == ()


def test_what_stale_keypoints_lost_is_compared_pair_by_pair(tmp_path: Path) -> None:
    """By hand: published 1 and 3 of 10 where 5 and 9 are right; 0 of 0 is nothing."""
    names = {"detector": "orb", "descriptor": "brisk", "norm": "ham", "matcher": "bf"}
    every = {key: pl.lit(name) for key, name in names.items()}
    first = 5 * PLACES["bark"]
    figures = {"pair": [first, first + 1, first + 2, 5], "inliers": [1, 3, 0, 8]}
    published = pl.DataFrame(figures).with_columns(
        **every,
        matches=pl.Series([10, 10, 0, 8]),
        dataset=pl.lit("oxford"),
        platform=pl.lit("desktop"),
    )
    published.write_parquet(tmp_path / "published.parquet")
    ours = pl.DataFrame({"pair": [0, 1, 2], "inliers": [5, 9, 1], "matches": [10, 10, 2]})
    ours = ours.with_columns(
        sequence=pl.lit("bark"), **{k: pl.lit(name.upper()) for k, name in names.items()}
    )
    ratios = both_measured(ours, published_pairs(tmp_path / "published.parquet"))
    assert lost(ratios, "descriptor").splitlines()[2:] == ["| BRISK | 1 | 0.20 | 0.70 | 0.50 |"]


@pytest.mark.slow
@pytest.mark.shared_data
def test_published_sequences_are_recognised(shared_data: Path) -> None:
    published = published_pairs(shared_data / PUBLISHED)
    [ours] = Findings().results(["oxford-thesis"])
    keys = ["detector", "descriptor", "norm", "matcher", "sequence", "step"]
    own = ours.table().with_columns(
        *(pl.col(key).cast(pl.String) for key in keys[:4]), step=pl.col("pair") % PAIRS
    )
    sift = own.filter(pl.col("detector") == "SIFT", pl.col("descriptor") == "SIFT")
    both = sift.filter(pl.col("matcher") == "BF").join(published, on=keys, suffix="_published")
    assert len(both) == PAIRS * len(PLACES)
    ratio = (both["matches_published"] / both["matches"]).to_numpy()
    assert ratio == pytest.approx(1, abs=0.03)


def test_the_times_of_a_part_are_cpu_times(finished: Path, stand_in: Path) -> None:
    measured = aerocues.Results(finished).table()
    stored = aerocues.Study(stand_in).part(NAMES[0]).table()
    assert stored["match_seconds"].equals(measured["match_seconds_cpu"])
    assert stored["match_seconds"].null_count() < len(stored)


def test_a_broken_database_is_not_an_empty_one(stand_in: Path, tmp_path: Path) -> None:
    assert Findings(tmp_path).study is None
    shutil.copytree(stand_in, tmp_path, dirs_exist_ok=True)
    (tmp_path / NAMES[0] / "run.json").write_text("{")
    with pytest.raises(AerocuesError):
        Findings(tmp_path).measured()


def test_who_suffers_most_is_told(tmp_path: Path) -> None:
    right = {"suburb-nadir-tuned": (100.0, 50.0), "suburb-oblique-tuned": (80.0, None)}
    for part, numbers in right.items():
        rows = [
            {
                **empty_row(),
                "dataset": part,
                "pair": 0,
                "detector": detector,
                "descriptor": "BRISK",
                "norm": "HAM",
                "matcher": "BF",
                "row_key": detector,
                "settings_key": "one",
                "status": "ok",
                "ref_matches@3": number,
            }
            for detector, number in zip(("ORB", "STAR"), numbers, strict=True)
        ]
        table = pl.DataFrame(rows, schema=polars_schema())
        facts = {"settings_key": "one", "study": {"steps": FINISHED}}
        content = folder_content(facts, plan_of(table), table, None)
        for name, data in content.items():
            (tmp_path / part / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / part / name).write_bytes(data)
    told = Findings(tmp_path).oblique()
    assert "STAR suffers most: it keeps 0% of its right matches (50 a pair become 0, on 1" in told
    assert "ORB keeps 80%" in told


def test_the_model_of_a_choice_is_told_beside_colmaps() -> None:
    """By hand: qualities 80, 60, 40, 20; COLMAP's default is third."""
    names = ["ORB-ORB-HAM-BF", "SIFT-SIFT-L2-BF", COLMAP_DEFAULT, "MSD-BRISK-HAM-BF"]
    figures: dict[str, list[Any]] = {COMBINATION: names, MODEL_QUALITY: [80.0, 60.0, 40.0, 20.0]}
    same = {"points_in_3_images": 9, "reprojection_error": 0.5, **dict.fromkeys(NO_TRUTH)}
    images = {"placed_images": 4, "images": 5, "reconstruction_seconds": 7.0}
    figures["focal_length"] = [500.0, 500.0, 640.0, 500.0]
    every = pl.DataFrame(figures).with_columns(
        **{name: pl.lit(value) for name, value in (same | images).items()}
    )
    built = Built("one", every, "MSD-BRISK-HAM-BF")
    told = "`one`: 2 of 3 combinations with a model have a better one than COLMAP's default; what"
    assert built.sentence().startswith(told)
    assert "has place 4, with 25% of the quality of the best" in built.sentence()
    assert "refines the focal length from 500 to 640 px" in built.sentence()
    of_second = built.of_the_best("SIFT-SIFT-L2-BF")
    assert "place 2, with 75% of the quality of the best, that of ORB-ORB-HAM-BF" in of_second
    assert "COLMAP's default has place 3" in of_second
    assert built.of_the_best("KAZE-KAZE-L2-BF") == ""
    assert [line[1:3] for line in built.lines()] == [
        ("1", "`ORB-ORB-HAM-BF`"),
        ("2", "`SIFT-SIFT-L2-BF`"),
        ("3", "COLMAP's default"),
        ("4", "`MSD-BRISK-HAM-BF`"),
    ]
    assert built.lines()[0][3:] == ("4 of 5", "9", "0.50", "", "", "7", "80")


def test_what_each_detector_keeps_is_told_by_descriptor() -> None:
    """By hand: of 10 detectors, D0 keeps 10 of 100 with SIFT; with ORB two keep nothing."""
    rows = [
        {"descriptor": descriptor, "detector": f"D{at}", "matcher": "BF", "status": status}
        | {"ref_matches@3": right, "turned": turned}
        for descriptor in ("SIFT", "ORB")
        for at in range(10)
        for turned, right, status in (
            (False, 100.0, "ok"),
            (True, 10.0 + at, "chance" if descriptor == "ORB" and at < 2 else "ok"),
            (None, 500.0, "ok"),
        )
    ]
    kept = kept_by(pl.DataFrame(rows), pl.col("turned"))
    assert kept.filter(detector="D3")["kept"].to_list() == pytest.approx([0.13, 0.13])
    assert others_told(kept) == (
        " With other descriptors: SIFT D0 (10%). With ORB, several detectors keep nothing."
    )


@pytest.mark.parametrize("query", QUERIES)
def test_the_questions_are_asked_as_the_page_shows(query: str, stand_in: Path, call: Call) -> None:
    shown = console(query)
    assert shown in PAGE.read_text(encoding="utf-8")
    command = shown.split("$ ", 1)[1].removesuffix("\n```").replace("\\\n", " ")
    _, verb, *words = shlex.split(command)
    assert words == ["--sql", QUERIES[query][0].replace("\n", "  ")]
    asked = call(verb, stand_in, *words)
    assert asked.code == 0, asked.err


@pytest.mark.slow
def test_its_other_commands_run(
    stand_in: Path, call: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("AEROCUES_STUDY", str(stand_in))
    ran = 0
    for block in blocks(PAGE):
        for command, _ in block.commands():
            asked = any(f"FROM {table}" in command for table in ("results", "reconstructions"))
            if not command.startswith("aerocues") or asked:
                continue
            words = shlex.split(command.replace("PART", "uav-tuned"))[1:]
            assert call(*words).code == 0, command
            ran += 1
        if block.language == "py":
            exec(block.text, {})
            ran += 1
    assert ran == 5


@pytest.mark.slow
def test_the_database_is_small_and_has_no_places() -> None:
    assert sum(file.stat().st_size for file in DATABASE.rglob("*")) < 30e6
    study = aerocues.Study(DATABASE)
    for name in study.names:
        facts = study.part(name).settings
        assert "source" not in facts["dataset"]
        assert facts.get("features") is None
        messages = study.part(name).table()["message"].drop_nulls()
        assert not any(
            re.search(r"(?<![\w.~/-])/(?:root|tmp|home|mnt)/", each) for each in messages
        )
