"""What goes wrong in a method, in a process or on the disk costs only itself."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest

from aerocues.datasets.dataset import Dataset
from aerocues.evaluation.run import run
from aerocues.methods.presets import Preset
from aerocues.results.measured_results import Results
from tests.evaluation.faults import HEALTHY, entry_points, mark, workers_of
from tests.evaluation.inline import InlineEngine
from tests.evaluation.scenes import PLAIN, Rows, assert_same_rows, rows_of, strip, write_dataset
from tests.methods.distribution import write_distribution

# Pairs 0-1, 1-2, 2-3, 3-4 of five views; the marked one is view 2: pairs 1 and 2 suffer.
GUILTY = "view_2.png"
SUFFERING = frozenset({1, 2})
# On a busy machine an honest call may sit idle for seconds.
TIMEOUT = 8
LIMITS: dict[str, Any] = {"workers": 2, "timeout": TIMEOUT, "memory_limit": 700 / 1024}

OUTCOMES = {
    "SEGFAULT": ("crashed", "SIGSEGV"),
    "LEAVE": ("crashed", "exit code 3"),
    "STRANGE": ("crashed", "KeyboardInterrupt"),
    "SLEEP": ("timeout", f"idle for {TIMEOUT} seconds"),
    "BURN": ("timeout", f"{TIMEOUT} CPU seconds"),
    "ALLOCATE": ("out_of_memory", "Unable to allocate"),
    "GROW": ("out_of_memory", "Unable to allocate"),
    "GROW_SHARED": ("out_of_memory", "700 MB"),
    "FAIL": ("error", "ValueError: this image is not to my taste"),
    "CV2": ("error", "OpenCV"),
    "NONSENSE": ("error", "TypeError"),
}
HONEST = ("ok", "chance", "no_model")
# What a process that goes on with other work could blame on others; the rest shares one run.
ALONE = ("GROW", "GROW_SHARED", "STRANGE")


@dataclass(frozen=True)
class Arena:
    """A dataset with a marked image, and where results go."""

    dataset: Dataset
    folder: Path
    monkeypatch: pytest.MonkeyPatch
    preset: str | Preset = PLAIN

    def install(self, *names: str) -> None:
        """Install methods that go wrong."""
        write_distribution(self.folder / "site", "faults", entry_points(names), {})
        self.monkeypatch.syspath_prepend(self.folder / "site")

    def between_others(self) -> Arena:
        """The same with one guilty pair, which has honest ones on both sides."""
        pairs = [pair for n, pair in enumerate(self.dataset.pairs) if n != max(SUFFERING)]
        return replace(self, dataset=replace(self.dataset, pairs=pairs))

    def first_pairs(self) -> Arena:
        """The same with an honest pair and a guilty one."""
        return replace(self, dataset=replace(self.dataset, pairs=self.dataset.pairs[:2]))

    def healthy(self, combinations: str) -> Rows:
        """The rows of a run in which nothing goes wrong."""
        with self.monkeypatch.context() as patch:
            patch.setenv(HEALTHY, "1")
            results = run(
                *(self.dataset, combinations, self.folder / "healthy"),
                timing="shared",
                preset=self.preset,
                engine=InlineEngine(),
            )
            return rows_of(results.table())

    def run(self, combinations: str, *, retry_failed: bool = False) -> Results:
        return run(
            *(self.dataset, combinations, self.folder / "results"),
            timing="shared",
            preset=self.preset,
            retry_failed=retry_failed,
            **LIMITS,
        )


@pytest.fixture
def arena(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Arena]:
    pictures = strip(5)
    mark(pictures[GUILTY])
    monkeypatch.setenv("AEROCUES_TEST_RUN", str(tmp_path))
    yield Arena(write_dataset(tmp_path / "images", pictures), tmp_path, monkeypatch)
    assert not workers_of(str(tmp_path))


def assert_only_the_guilty_failed(
    results: Results, healthy: Rows, faults: Sequence[str], pairs: Set[int] = SUFFERING
) -> None:
    """Rows of faulty methods on the marked image failed as expected; the rest is untouched."""
    rows = rows_of(results.table())
    assert rows.keys() == healthy.keys()
    failed = {name for name, row in rows.items() if row["status"] not in HONEST}
    guilty = {
        name: fault
        for name, row in healthy.items()
        for fault in faults
        if row["pair"] in pairs and fault in (row["detector"], str(row["descriptor"])[2:])
    }
    assert failed == guilty.keys()
    assert set(guilty.values()) == set(faults)
    for name, fault in guilty.items():
        status, words = OUTCOMES[fault]
        message = str(rows[name]["message"])
        assert rows[name]["status"] == status, message
        assert words in message
        assert GUILTY in message
        assert fault in message
    assert_same_rows(
        {name: row for name, row in rows.items() if name not in failed},
        {name: row for name, row in healthy.items() if name not in failed},
    )


def combinations_of(fault: str) -> str:
    return f"{fault}-ORB-HAM-BF,ORB-D_{fault}-HAM-BF,ORB-ORB-HAM-BF"


@pytest.mark.slow
@pytest.mark.parametrize("fault", ALONE)
def test_a_fault_costs_only_itself(arena: Arena, fault: str) -> None:
    arena.install(fault, f"D_{fault}")
    combinations, small = combinations_of(fault), arena.between_others()
    healthy = small.healthy(combinations)
    assert_only_the_guilty_failed(small.run(combinations), healthy, [fault], {1})


@pytest.mark.slow
def test_several_faults_in_one_run(arena: Arena) -> None:
    several = [fault for fault in OUTCOMES if fault not in ALONE]
    arena.install(*several, *(f"D_{fault}" for fault in several))
    # Two descriptors share a detector that crashes; what burns takes all of its time, so only one.
    combinations = ",".join(
        ["SEGFAULT-BRIEF-HAM-BF", *map(combinations_of, several), "!*-D_BURN-*"]
    )
    small = arena.between_others()
    healthy = small.healthy(combinations)
    assert_only_the_guilty_failed(small.run(combinations), healthy, several, {1})


@pytest.mark.slow
def test_a_crash_costs_only_its_pair(arena: Arena) -> None:
    arena.install("SEGFAULT")
    small = arena.first_pairs()
    healthy = small.healthy("SEGFAULT-ORB-HAM-BF,ORB-ORB-HAM-BF")
    results = small.run("SEGFAULT-ORB-HAM-BF,ORB-ORB-HAM-BF")
    assert_only_the_guilty_failed(results, healthy, ["SEGFAULT"])


@pytest.mark.slow
def test_a_matcher_that_kills_its_process_costs_only_its_rows(arena: Arena) -> None:
    arena.install("KILLER")
    combinations = "ORB-ORB-HAM-KILLER,ORB-ORB-HAM-BF"
    small = arena.first_pairs()
    healthy = small.healthy(combinations)
    rows = rows_of(small.run(combinations).table())
    for name, row in rows.items():
        if row["matcher"] == "KILLER":
            assert row["status"] == "crashed"
            assert "SIGSEGV" in str(row["message"])
            assert "match ORB-ORB-HAM-KILLER on" in str(row["message"])
        else:
            assert_same_rows({name: row}, {name: healthy[name]})


@pytest.mark.slow
def test_failed_rows_are_measured_again_on_demand(arena: Arena) -> None:
    arena.install("SEGFAULT", "FAIL")
    combinations = "SEGFAULT-ORB-HAM-BF,FAIL-ORB-HAM-BF,ORB-ORB-HAM-BF"
    small = replace(arena.first_pairs(), preset="default")
    healthy = small.healthy(combinations)
    first = rows_of(small.run(combinations).table())
    failed = sorted(str(row["status"]) for row in first.values() if row["status"] != "ok")
    assert failed == ["crashed", "error"]
    arena.monkeypatch.setenv(HEALTHY, "1")
    assert rows_of(small.run(combinations).table()) == first
    again = small.run(combinations, retry_failed=True)
    assert_same_rows(rows_of(again.table()), healthy)
    assert again.status().statuses == {"ok": 6}
