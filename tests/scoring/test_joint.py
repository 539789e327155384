"""Two runs over the same images, scored as one table."""

from __future__ import annotations

from typing import Any

import numpy as np
import polars as pl
import pytest
from scipy.stats import ttest_rel, wilcoxon

from aerocues.errors import ArgumentError, ScoreError
from aerocues.results.export import tables_content
from aerocues.scoring.across import Entry, entries_of
from aerocues.scoring.compared import ComparedResults, compare_entries
from aerocues.scoring.joint import JointScores, score_jointly
from aerocues.scoring.significance import holm
from tests.scoring.measurements import row, rows
from tests.scoring.test_comparison import InFolder

ORB, SIFT, KAZE = "ORB-ORB-HAM-BF", "SIFT-SIFT-L2-BF", "KAZE-KAZE-L2-BF"
PAIRS = 8
FIRST = {ORB: [20, 24, 30, 22, 26, 28, 20, 30], SIFT: [60, 62, 58, 66, 64, 60, 70, 60]}
SECOND = {ORB: [60, 58, 66, 70, 60, 62, 64, 70], SIFT: [60, 64, 58, 64, 66, 60, 68, 60]}


def run(inliers: dict[str, list[int]], folder: str, shift: int = 0, **changes: Any) -> InFolder:
    """One run; its pairs are numbered from `shift` on, their images are the same."""
    found = InFolder(folder)
    found._table = rows(
        *(
            row(name, pair, inliers=number, **changes) | {"pair": pair + shift}
            for name, numbers in inliers.items()
            for pair, number in enumerate(numbers)
        )
    )
    return found


def entries(*results: InFolder) -> list[Entry]:
    return entries_of(results, "thesis", criteria="inliers", alpha=1.0)


def joint(*results: InFolder, **settings: Any) -> JointScores:
    return score_jointly(*entries(*results), **settings)


def test_one_normalisation_holds_for_both_runs() -> None:
    found = joint(run(FIRST, "r"), run(SECOND, "s", shift=3)).differences()
    # One criterion, alpha 1: the mean between the least (20) and the most (70) inliers of all.
    by_name = {each["combination"]: each for each in found.to_dicts()}
    for name in (ORB, SIFT):
        each = by_name[name]
        first, second = ((np.mean(values[name]) - 20) / 50 for values in (FIRST, SECOND))
        assert each["first_score"] == pytest.approx(first)
        assert each["second_score"] == pytest.approx(second)
        assert each["difference"] == pytest.approx(second - first)
    assert (by_name[ORB]["first_rank"], by_name[ORB]["second_rank"]) == (2, 1)
    # By itself, the second run goes from 58 to 70.
    alone = entries(run(SECOND, "s"))[0].scores.scores
    assert alone == pytest.approx([(63.75 - 58) / 12, (62.5 - 58) / 12])


def test_differences_are_tested_in_pairs_and_corrected() -> None:
    found = joint(run(FIRST, "r"), run(SECOND, "s"), resamples=4000).differences()
    names = found["combination"].to_list()
    plain = np.array([ttest_rel(SECOND[name], FIRST[name]).pvalue for name in names])
    assert found["p_value"].to_list() == pytest.approx(holm(plain).tolist(), rel=0.5)
    assert found.filter(pl.col("combination") == ORB)["p_value"].item() < 0.001
    low, high = (
        found.filter(pl.col("combination") == ORB)[f"difference_{end}"].item()
        for end in ("low", "high")
    )
    interval = ttest_rel(SECOND[ORB], FIRST[ORB]).confidence_interval()
    assert (low, high) == pytest.approx((interval.low / 50, interval.high / 50), rel=0.06)
    ranked = joint(run(FIRST, "r"), run(SECOND, "s"), test="wilcoxon").differences()
    signed = np.array([wilcoxon(np.subtract(SECOND[n], FIRST[n])).pvalue for n in names])
    expected = holm(np.where(signed > 0.5, 1.0, signed))
    assert ranked["p_value"].to_list() == pytest.approx(expected.tolist())


def test_criteria_tell_where_the_difference_comes_from() -> None:
    failing = SECOND | {SIFT: SECOND[SIFT][:-1]}
    second = run(failing, "s")
    lost = row(SIFT, PAIRS - 1, status="too_few_matches")
    second._table = pl.concat([second._table, rows(lost)], how="diagonal_relaxed")
    found = joint(run(FIRST, "r"), second).criteria()
    success, inliers = found.to_dicts()
    assert (success["criterion"], success["better"]) == ("success_rate", "higher")
    assert (success["first"], success["second"]) == (1, pytest.approx(15 / 16))
    both = [*np.subtract(SECOND[ORB], FIRST[ORB]), *np.subtract(SECOND[SIFT], FIRST[SIFT])[:-1]]
    assert inliers["difference"] == pytest.approx(np.mean(both))
    assert inliers["p_value"] == pytest.approx(2 / 2**PAIRS * 2)


def test_only_what_both_runs_measured_counts() -> None:
    more = run(FIRST | {KAZE: [90] * PAIRS}, "r")
    fewer = run({name: values[:6] for name, values in SECOND.items()}, "s")
    found = joint(more, fewer)
    assert found.combinations == (ORB, SIFT)
    assert found.pairs == 6


def test_few_pairs_are_not_tested() -> None:
    few = [run({name: v[:4] for name, v in each.items()}, "rs"[n]) for n, each in
           enumerate((FIRST, SECOND))]  # fmt: skip
    found = joint(*few)
    assert found.differences()["p_value"].null_count() == 2
    assert found.criteria()["p_value"].null_count() == 2


def test_runs_without_anything_in_common_are_told_apart() -> None:
    first, other = entries(run(FIRST, "r"), run({KAZE: SECOND[ORB]}, "s"))
    with pytest.raises(ScoreError, match="combination"):
        score_jointly(first, other)
    elsewhere = run(SECOND, "s", image_1="other.jpg")
    with pytest.raises(ScoreError, match="pair of images"):
        joint(run(FIRST, "r"), elsewhere)
    with pytest.raises(ArgumentError, match="test"):
        joint(run(FIRST, "r"), run(SECOND, "s"), test="sign")
    (runs,) = compare_entries(entries(run(FIRST, "r"), elsewhere)).runs
    assert isinstance(runs.joint, str)


@pytest.fixture(scope="module")
def compared() -> ComparedResults:
    changed = run(SECOND, "s", preset="tuned")
    return compare_entries(entries(run(FIRST, "r", preset="default"), changed))


def test_the_table_of_two_runs_holds_their_differences(compared: ComparedResults) -> None:
    assert "difference" in compared.frame().columns
    assert [entry.name for entry in compared.entries] == ["flight (default)", "flight (tuned)"]


@pytest.mark.parametrize(
    ("form", "start"), [("markdown", "**Spearman"), ("latex", r"\begin{table}"), ("csv", "table,")]
)
def test_all_tables_go_into_one_file(compared: ComparedResults, form: str, start: str) -> None:
    text = bytes(tables_content(compared.tables(), form)).decode()
    assert text.startswith(start)
    assert "flight (tuned) (second)" in text
    if form == "latex":
        assert text.count(r"\begin{table}") == text.count(r"\end{table}") == 5
