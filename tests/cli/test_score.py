"""`aerocues score`, `validate` and `compare` on a finished run."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import polars as pl
import pytest

import aerocues
from tests.cli.conftest import Call
from tests.report.made_up_models import MODELLED, STATUSES, with_models

CRITERIA = "precision,inliers,total_seconds"


@pytest.fixture
def elsewhere(finished: Path, tmp_path: Path) -> Path:
    """The same results under another name, as if measured on a slower machine."""
    from tests.cli.other_machine import slower_copy

    return slower_copy(finished, tmp_path / "elsewhere")


def test_a_ranking_is_a_table_with_intervals_and_weights(call: Call, finished: Path) -> None:
    answer = call("score", finished, "--resamples", 50)
    assert answer.code == 0
    lines = answer.out.splitlines()
    assert lines[0].endswith("4 combinations on 3 pairs")
    assert max(map(len, lines)) <= 100
    ranked = [line.split() for line in lines[3:7]]
    assert [words[0] for words in ranked] == ["1", "2", "3", "4"]
    scores = [float(words[2]) for words in ranked]
    assert scores == sorted(scores, reverse=True)
    assert "ref_precision@3" in answer.out
    assert "preset default" in answer.out


def test_times_of_several_kinds_of_machine_are_not_mixed_in_silence(
    call: Call, finished: Path, tmp_path: Path
) -> None:
    from tests.cli.other_machine import slower_copy

    mixed = slower_copy(finished, tmp_path / "mixed")
    assert "slow board" not in call("score", mixed).out
    parts = sorted((mixed / "parts").glob("*.parquet"))
    parts[0].write_bytes((finished / "parts" / parts[0].name).read_bytes())
    assert "slow board" in call("score", mixed).out


def test_json_has_ranking_weights_and_settings(call: Call, finished: Path) -> None:
    facts = json.loads(call("score", finished, "--json", "--seed", 3, "--resamples", 60).out)
    ranking = facts["ranking"]
    assert len(ranking) == 4
    wanted = {"combination", "score", "score_low", "score_high", "rank", "rank_low", "rank_high"}
    wanted |= {"probability_best", "success_rate", "ref_precision@3", "coverage"}
    for row in ranking:
        assert wanted <= row.keys()
        assert row["rank_low"] <= row["rank_high"]
    assert sum(row["probability_best"] for row in ranking) == pytest.approx(1, abs=0.1)
    for method in ("entropy", "variance", "critic", "pca", "aggregate"):
        assert sum(row[method] for row in facts["weights"].values()) == pytest.approx(1)
    assert facts["settings"]["preset"] == "default"
    assert (facts["settings"]["seed"], facts["settings"]["resamples"]) == (3, 60)


def test_python_gives_the_same_ranking(call: Call, finished: Path) -> None:
    facts = json.loads(call("score", finished, "--json", "--resamples", 40, "--seed", 5).out)
    ranking = aerocues.score(aerocues.Results(finished), resamples=40, seed=5)
    assert ranking.frame("combination").to_dicts() == facts["ranking"]


def test_others_are_tested_against_a_chosen_one_and_columns_chosen(
    call: Call, finished: Path, tmp_path: Path
) -> None:
    one = "AKAZE-AKAZE-HAM-BF"
    target = tmp_path / "short.tex"
    options = ("--resamples", 20, "--against", one.lower())
    told = json.loads(call("score", finished, *options, "--json").out)
    assert told["settings"]["against"] == one
    names = ("--columns", "rank,combination,p_value")
    answer = call("score", finished, *options, "--latex", target, *names)
    # With three pairs there is no test.
    assert f"too few pairs for a test against {one}" in " ".join(answer.out.split())
    assert "rank & combination & p\\_value" in target.read_text()
    assert call("score", finished, *options, "--latex", target, "--columns", "speed").code == 2
    assert call("score", finished, "--against", "ORB").code == 2


@pytest.mark.parametrize(
    "options",
    [
        ("--latex", "-", "--columns", "rank,rank"),
        ("--markdown", "-", "--columns", " , "),
        ("--columns", "rank"),
    ],
)
def test_columns_that_say_nothing_are_refused(
    call: Call, finished: Path, options: tuple[str, ...]
) -> None:
    answer = call("score", finished, *options)
    assert answer.code == 2
    assert "--columns" in answer.err


def test_choices_change_what_is_scored(call: Call, finished: Path) -> None:
    options = ["--criteria", CRITERIA, "--weights", "entropy", "--aggregation", "trimmed"]
    options += ["--alpha", "0.25", "--failures", "omit", "--interval", "pairwise"]
    options += ["--test", "wilcoxon", "--preset", "thesis", "--resamples", "20"]
    settings = json.loads(call("score", finished, *options, "--json").out)["settings"]
    assert settings["criteria"] == CRITERIA.split(",")
    assert settings["weights"] == ["entropy"]
    assert (settings["alpha"], settings["aggregation"]) == (0.25, "trimmed")
    assert (settings["failures"], settings["preset"]) == ("omit", "thesis")
    assert (settings["interval"], settings["test"]) == ("pairwise", "wilcoxon")


def test_rankings_go_to_files(call: Call, finished: Path, tmp_path: Path) -> None:
    files = {form: tmp_path / f"ranking.{form}" for form in ("csv", "latex", "markdown")}
    options = [word for form, file in files.items() for word in (f"--{form}", file)]
    answer = call("score", finished, *options, "--top", 2, "--resamples", 20)
    assert answer.code == 0
    assert len(pl.read_csv(files["csv"])) == 4
    latex = files["latex"].read_text()
    assert latex.count(r"\\") == 3  # the head and two rows
    assert r"\toprule" in latex
    assert len(files["markdown"].read_text().strip().splitlines()) == 4


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--criteria", "recal"], "recall"),
        (["--criteria", ""], "criteri"),
        (["--criteria", "inliers,inliers"], "inliers"),
        (["--preset", "best"], "'best'"),
        (["--weights", "mine"], "'mine'"),
        (["--aggregation", "sum"], "'sum'"),
        (["--alpha", "0"], "alpha"),
        (["--dataset", "mars"], "'mars'"),
        (["--resamples", "1"], "--resamples"),
        (["--reconstruction"], "reconstruct"),
        (["--criteria", "inliers,gt_repeatability"], "gt_repeatability"),
    ],
)
def test_wrong_choices_are_told_in_one_line(
    call: Call, finished: Path, options: list[str], told: str
) -> None:
    answer = call("score", finished, *options)
    assert answer.code == 2
    assert answer.err.startswith("error: ")
    assert told in answer.err
    assert answer.err.count("\n") == 1


def test_failed_reconstructions_count_as_failures(call: Call, tmp_path: Path) -> None:
    folder = with_models(tmp_path).folder
    chosen = ["--criteria", "precision,points_3d,registered_share", "--resamples", 10]
    ranking = json.loads(call("score", folder, *chosen, "--json").out)["ranking"]
    assert len(ranking) == len(MODELLED)  # all have a score
    status = dict(zip(MODELLED, STATUSES, strict=True))
    for row in ranking:
        known = row["registered_share"] is not None
        assert known == (status[row["combination"]] == "ok")
    assert status[ranking[0]["combination"]] == "ok"


def test_validation_has_all_its_sections(call: Call, finished: Path) -> None:
    answer = call("validate", finished)
    assert answer.code == 0
    for title in (
        "power alpha",
        "aggregation of the weights",
        "criteria left out",
        "other methods",
        "criteria: Pearson",
        "detectors by mean CUES",
        "descriptors by mean CUES",
        "norms by mean CUES",
        "matchers by mean CUES",
        "Pareto front of",
        "rank reversal",
        "mean ranks of the best",
    ):
        assert title in answer.out
    assert max(map(len, answer.out.splitlines())) <= 100


def test_validation_as_json(call: Call, finished: Path) -> None:
    options = ["--criteria", CRITERIA, "--speed", "total_seconds", "--quality", "inliers"]
    facts = json.loads(call("validate", finished, *options, "--json").out)
    assert facts["alpha"]["names"] == ["0.1", "0.25", "0.5", "0.75"]
    assert facts["aggregation"]["correlation"][0][0] == pytest.approx(1)
    assert facts["criterion_left_out"]["names"][1:] == [
        f"without {name}" for name in CRITERIA.split(",")
    ]
    assert facts["agreement"]["names"][0] == "CUES"
    assert facts["criteria_correlation"]["names"] == CRITERIA.split(",")
    assert {row["name"] for row in facts["hierarchies"]["detectors"]} == {"ORB", "AKAZE", "GFTT"}
    assert facts["pareto"]["criteria"] == ["total_seconds", "inliers"]
    assert facts["pareto"]["front"]
    assert facts["rank_reversal"]["rounds"] == 100
    assert len(facts["critical_difference"]["mean_ranks"]) == 4


def test_an_axis_that_is_no_criterion_is_told(call: Call, finished: Path) -> None:
    answer = call("validate", finished, "--speed", "beauty")
    assert answer.code == 2
    assert "'beauty'" in answer.err


def test_machines_are_compared_by_their_times(call: Call, finished: Path, elsewhere: Path) -> None:
    answer = call("compare", finished, elsewhere)
    assert answer.code == 0
    assert max(map(len, answer.out.splitlines())) <= 100
    assert "scored together: 4" in answer.out
    assert "slow board" in answer.out
    facts = json.loads(call("compare", finished, elsewhere, "--json").out)
    (runs,) = facts["runs"]
    assert len(runs["differences"]) == 4
    by_stage = {row["stage"]: row for row in runs["times"]}
    assert by_stage["match"]["ratio"] == pytest.approx(3)
    assert facts["shared"] == [[4, 4], [4, 4]]
    assert len(facts["versatility"]) == 4
    assert facts["overview"] is None
    assert len(runs["machines"]["combinations"]) == runs["machines"]["kept_in_top"] == 4


def test_datasets_are_put_together(call: Call, finished: Path, tmp_path: Path) -> None:
    other = tmp_path / "other"
    shutil.copytree(finished, other)
    for file in (other / "plan.parquet", *sorted((other / "parts").glob("*.parquet"))):
        renamed = pl.read_parquet(file).with_columns(pl.lit("other").alias("dataset"))
        renamed.write_parquet(file)
    answer = call("compare", finished, other)
    assert answer.code == 0
    assert max(map(len, answer.out.splitlines())) <= 100
    facts = json.loads(call("compare", finished, other, "--json").out)["overview"]
    assert facts["datasets"] == ["photos", "other"]
    assert facts["evaluations"] == 8
    assert facts["kept_in_top"] == [[4, 4], [4, 4]]
    assert facts["range_of_bests"] == pytest.approx(0)
    assert sum(row["evaluations"] for row in facts["hierarchies"]["detectors"]) == 8


def test_scores_of_all_results_go_to_a_file(
    call: Call, finished: Path, elsewhere: Path, tmp_path: Path
) -> None:
    file = tmp_path / "scores.csv"
    assert call("compare", finished, elsewhere, "--csv", file, "--over", "all").code == 0
    assert pl.read_csv(file)["combination"].n_unique() == 4


def test_files_may_be_standard_output(call: Call, finished: Path, elsewhere: Path) -> None:
    printed = call("score", finished, "--csv", "-", "--resamples", 20).out
    assert len(pl.read_csv(printed.encode())) == 4
    printed = call("compare", finished, elsewhere, "--csv", "-").out
    assert len(pl.read_csv(printed.encode())) == 4


def test_tables_for_papers(call: Call, finished: Path, elsewhere: Path) -> None:
    printed = call("compare", finished, elsewhere, "--latex", "-", "--top", 1).out
    # The last six are of the machines: combinations, and each kind of method.
    assert printed.count(r"\begin{tabular}") == 11
    bodies = [table.split(r"\bottomrule")[0] for table in printed.split(r"\midrule")[1:]]
    spearman, kendall, differences, criteria, times = (body.count(r"\\") for body in bodies[:5])
    assert (spearman, kendall, differences) == (2, 2, 1)
    assert min(criteria, times) > 1
    printed = call("validate", finished, "--markdown", "-").out
    assert "**Power alpha: Spearman's correlation**" in printed
    printed = call("validate", finished, "--csv", "-").out
    assert pl.read_csv(printed.encode()).columns == ["table", "row", "column", "value"]


@pytest.mark.parametrize("command", ["score", "validate", "compare"])
def test_tables_keep_ranks_and_names_where_it_is_narrow(
    call: Call, finished: Path, elsewhere: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    monkeypatch.setattr("aerocues.cli.console.WIDTH_OF_FILES", 80)
    answer = call(command, finished, *([elsewhere] if command == "compare" else []))
    assert answer.code == 0
    assert max(map(len, answer.out.splitlines())) <= 80
    assert "…" not in answer.out


def test_json_has_no_number_that_is_none(call: Call, finished: Path) -> None:
    def refuse(name: str) -> None:
        raise AssertionError(name)

    for command in ("score", "validate"):
        printed = call(command, finished, "--criteria", "inliers", "--json").out
        json.loads(printed, parse_constant=refuse)


def test_one_result_cannot_be_compared(call: Call, finished: Path) -> None:
    answer = call("compare", finished)
    assert answer.code == 2
    assert answer.err.startswith("error: ")


def test_results_without_a_row_cannot_be_scored(call: Call, finished: Path, tmp_path: Path) -> None:
    empty = tmp_path / "empty"
    shutil.copytree(finished, empty)
    for part in (empty / "parts").glob("*.parquet"):
        part.unlink()
    for command in ("score", "validate"):
        answer = call(command, empty)
        assert answer.code == 2
        assert answer.err.startswith("error: ")
