"""Quality of all pairs first, then the times of some."""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aerocues.datasets.dataset import Pair
from aerocues.evaluation import run as running
from aerocues.evaluation.passes import Pass, passes
from aerocues.progress import Event
from aerocues.results.measured_results import Results
from aerocues.results.metrics import PER_THOUSAND, add_metrics
from aerocues.results.scaled_times import with_scaled_times
from aerocues.results.schema import empty_row, polars_schema
from tests.evaluation.inline import InlineEngine
from tests.evaluation.scenes import PLAIN, assert_same_rows, rows_of, strip, write_dataset

FEW = "ORB-ORB-HAM-*,FAST-BRIEF-HAM-BF"
run = functools.partial(running.run, preset=PLAIN)
plan_run = functools.partial(running.plan_run, preset=PLAIN)
PASSES = {"estimated": "measuring", "shared": "measuring", "exclusive": "timing"}
STAGES = (
    *("detect_seconds_1", "detect_seconds_2", "describe_seconds_1", "describe_seconds_2"),
    *("match_seconds", "verify_seconds"),
)


@dataclass
class Passing:
    """Remembers the passes and the rows that they measured."""

    seen: dict[str, int] = field(default_factory=dict)

    def __call__(self, event: Event) -> None:
        if event.stage in PASSES.values():
            self.seen[event.stage] = self.seen.get(event.stage, 0) + len(event.rows)


def pairs_of(*sequences: str) -> list[Pair]:
    return [Pair(i, f"{i}a", f"{i}b", name) for i, name in enumerate(sequences)]


def test_only_exclusive_timing_of_some_pairs_takes_two_passes() -> None:
    pairs = pairs_of(*"aaaaaa")
    assert passes(pairs, "shared", 2, 0) == (Pass("shared"),)
    assert passes(pairs, "estimated", 2, 0) == (Pass("estimated"),)
    for enough in (0, 6, 9):
        assert passes(pairs, "exclusive", enough, 0) == (Pass("exclusive"),)
    first, second = passes(pairs, "exclusive", 2, 0)
    assert first == Pass("estimated")
    assert second.timing == "exclusive"
    assert second.pairs is not None
    assert len(second.pairs) == 2


def test_without_exact_search_the_first_pass_waits_for_brute_force(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("aerocues.evaluation.passes.why_not_exact", lambda: "no numba")
    first, second = passes(pairs_of(*"aaaaaa"), "exclusive", 2, 0)
    assert (first, second.timing) == (Pass("shared"), "exclusive")


def test_the_sample_is_spread_over_sequences_and_grows(tmp_path: Path) -> None:
    pairs = pairs_of(*"aaaaabbbccccccd")
    samples = []
    for count in range(1, len(pairs)):
        chosen = passes(pairs, "exclusive", count, 7)[1].pairs
        assert chosen is not None
        samples.append(chosen)
    assert {pairs[number].sequence for number in samples[3]} == set("abcd")
    assert all(small < large for small, large in itertools.pairwise(samples))
    assert passes(pairs, "exclusive", 4, 7) == passes(pairs, "exclusive", 4, 7)
    assert len({passes(pairs, "exclusive", 4, seed)[1].pairs for seed in range(20)}) > 1


@pytest.mark.slow
def test_rows_say_where_their_times_come_from(tmp_path: Path) -> None:
    dataset = write_dataset(tmp_path / "images", strip(5))
    seen, engine = Passing(), InlineEngine()
    results = run(dataset, FEW, tmp_path / "r", timing_pairs=2, engine=engine, progress=seen)
    assert seen.seen == {"measuring": 12, "timing": 6}
    table = results.table()
    assert table["timing"].value_counts().sort("timing").rows() == [("exclusive", 6), ("scaled", 6)]
    assert results.status().timings == {"exclusive": 6, "scaled": 6}
    timed = table.filter(pl.col("timing") == "exclusive")
    assert timed["pair"].n_unique() == 2
    assert timed["timing_repeats"].null_count() == 0
    shared = run(dataset, FEW, tmp_path / "s", timing="shared", engine=engine)
    assert_same_rows(rows_of(table), rows_of(shared.table()))


@pytest.mark.slow
def test_what_is_finished_is_not_timed_again_and_a_larger_sample_goes_on(tmp_path: Path) -> None:
    dataset = write_dataset(tmp_path / "images", strip(5))
    engine = InlineEngine()
    expected: list[tuple[int, list[tuple[str, int]]]] = [
        (1, [("estimated", 12), ("exclusive", 3)]),
        (1, [("estimated", 0), ("exclusive", 0)]),
        (3, [("estimated", 0), ("exclusive", 6)]),
        (0, [("exclusive", 3)]),
    ]
    for timed, measured in expected:
        plans = plan_run(dataset, FEW, tmp_path / "r", timing_pairs=timed)
        assert [(timing, plan.rows_left) for timing, plan in plans] == measured
        seen = Passing()
        run(dataset, FEW, tmp_path / "r", timing_pairs=timed, engine=engine, progress=seen)
        assert seen.seen == {PASSES[timing]: rows for timing, rows in measured}


def stop_before_timing(event: Event) -> None:
    """Interrupt between the passes."""
    if event.stage == "timing":
        raise KeyboardInterrupt


@pytest.mark.slow
def test_a_run_that_ended_between_the_passes_has_rows_left_to_time(tmp_path: Path) -> None:
    dataset, engine = write_dataset(tmp_path / "images", strip(5)), InlineEngine()
    with pytest.raises(KeyboardInterrupt):
        run(
            *(dataset, FEW, tmp_path / "r"),
            timing_pairs=2,
            engine=engine,
            progress=stop_before_timing,
        )
    status = Results(tmp_path / "r").status()
    assert (status.done, status.left, status.untimed) == (12, 0, 6)
    status = run(dataset, FEW, tmp_path / "r", timing_pairs=2, engine=engine).status()
    assert (status.done, status.left, status.untimed) == (12, 0, 0)


@pytest.mark.slow
def test_rows_of_other_settings_in_the_folder_are_told(tmp_path: Path) -> None:
    dataset, engine = write_dataset(tmp_path / "images", strip(5)), InlineEngine()
    told: list[str] = []

    def hear(event: Event) -> None:
        if "ignored" in event.message:
            told.append(event.message)

    for combinations, limit in (
        (FEW, 0),
        ("BRISK-BRISK-HAM-BF", 0),  # adds to what is there
        ("BRISK-BRISK-HAM-BF", 50),
    ):
        run(
            *(dataset, combinations, tmp_path / "r"),
            timing="shared",
            max_keypoints=limit,
            engine=engine,
            progress=hear,
        )
    (line,) = told
    assert line.startswith("16 rows ")


def row(number: int, timing: str, seconds: float, **known: Any) -> dict[str, Any]:
    made = empty_row() | {
        "dataset": "d",
        "pair": number,
        "image_1": "a",
        "image_2": "b",
        "machine": "here",
        "detector": "ORB",
        "descriptor": "ORB",
        "norm": "HAM",
        "matcher": "BF",
        "keypoints_1": 10,
        "keypoints_2": 20,
        "matches": 8,
        "inliers": 4,
        "status": "ok",
        "timing": timing,
        "row_key": f"k{number}",
        "measured_at": 1.0,
        **dict.fromkeys(STAGES, seconds),
        **{f"{name}_cpu": seconds / 2 for name in STAGES},
    }
    return add_metrics(made | known)


def scaled(rows: list[dict[str, Any]], best: list[dict[str, Any]]) -> list[dict[str, Any]]:
    measured, chosen = (
        pl.DataFrame(each, schema=polars_schema(), orient="row") for each in (rows, best)
    )
    return with_scaled_times(chosen, measured).to_dicts()


def test_times_are_scaled_by_what_the_timed_pairs_took_alone() -> None:
    # Beside others the two timed pairs took 1 + 3 s of wall, 0.5 + 1.5 s of CPU time a stage;
    # alone 1.5 + 1.5 s of wall and 0.75 + 0.75 s of CPU time: 3 / 2 and 1.5 / 2 of the CPU time.
    beside = [row(0, "estimated", 1.0), row(1, "estimated", 3.0), row(2, "estimated", 4.0)]
    alone = [row(0, "exclusive", 1.5), row(1, "exclusive", 1.5)]
    kept = scaled([*beside, *alone], [*alone, beside[2]])
    assert [each["timing"] for each in kept] == ["exclusive", "exclusive", "scaled"]
    for each, before in zip(kept[:2], alone, strict=True):
        assert each == before
    third = kept[2]
    assert third["match_seconds"] == pytest.approx(2.0 * 1.5)
    assert third["detect_seconds_2_cpu"] == pytest.approx(2.0 * 0.75)
    expected = add_metrics({**third})
    for name in ("total_seconds", *PER_THOUSAND):
        assert third[name] == pytest.approx(expected[name])
    assert third["total_seconds"] == pytest.approx(4 * 3.0)


@pytest.mark.parametrize(
    "other", [{"machine": "there"}, {"matcher": "FLANN"}, {"detector": "SIFT"}]
)
def test_times_of_other_machines_and_combinations_say_nothing(other: dict[str, str]) -> None:
    beside = [row(0, "shared", 1.0), row(1, "shared", 3.0, **other)]
    alone = row(0, "exclusive", 1.5)
    assert scaled([*beside, alone], [alone, beside[1]]) == [alone, beside[1]]


def test_a_stage_that_was_never_reached_stays_unknown() -> None:
    nothing: dict[str, Any] = {"verify_seconds": None, "verify_seconds_cpu": None, "matches": 0}
    beside = [row(0, "estimated", 1.0, **nothing), row(1, "estimated", 3.0, inliers=0)]
    beside.append(row(2, "estimated", 1.0, **nothing))
    alone = row(0, "exclusive", 2.0, **nothing)
    _, second, third = scaled([*beside, alone], [alone, *beside[1:]])
    assert second["match_seconds"] == pytest.approx(1.5 * 2 / 0.5)
    # No timed pair was verified: the time beside others stands.
    assert second["verify_seconds"] == 3.0
    assert (third["verify_seconds"], third["total_seconds"]) == (None, None)
    assert (second["seconds_per_1k_inliers"], third["seconds_per_1k_matches"]) == (None, None)


@given(st.lists(st.tuples(st.booleans(), st.floats(0.001, 100), st.floats(0.001, 100)), min_size=1))
def test_scaled_rows_keep_their_number_and_order(
    times: list[tuple[bool, float, float]],
) -> None:
    rows, best = [], []
    for number, (timed, beside, alone) in enumerate(times):
        rows.append(row(number, "estimated", beside))
        best.append(row(number, "exclusive", alone) if timed else rows[-1])
        rows += best[-1:] if timed else []
    kept = scaled(rows, best)
    assert [each["row_key"] for each in kept] == [each["row_key"] for each in best]
    expected = "scaled" if any(timed for timed, _, _ in times) else "estimated"
    for each, (timed, _, _) in zip(kept, times, strict=True):
        assert each["timing"] == ("exclusive" if timed else expected)
