"""In which order models are begun, with processes that answer at once."""

from __future__ import annotations

import math
from multiprocessing import Pipe
from typing import Any

import pytest

from aerocues.methods.combination import Combination
from aerocues.reconstruction import engine
from aerocues.reconstruction.engine import ReconstructionLimits, in_groups, run_reconstructions
from aerocues.reconstruction.matching import Matching
from aerocues.reconstruction.remaining_time import RemainingTime
from aerocues.results.reconstruction_schema import BASELINE

RANKED = [
    Combination.parse(name)
    for name in ("ORB-ORB-HAM-BF", "SIFT-SIFT-L2-BF", "AKAZE-AKAZE-HAM-BF", "STAR-BRISK-HAM-BF")
]
FAR = 1e9


class Process:
    """Has done its work as soon as it is given it; a model takes ten seconds."""

    share = 1.0
    alive: list[str]
    begun: list[tuple[str, tuple[str, ...]]]
    wall_seconds = 10.0

    def __init__(self) -> None:
        self.pipe, self._theirs = Pipe()
        self.name = ""

    @property
    def core_share(self) -> float:
        return self.share

    def send(self, work: Any) -> None:
        ahead = isinstance(work, Matching)
        self.name = f"matches of {work.combination.detector}" if ahead else work.detector
        self.begun.append((self.name, tuple(self.alive)))
        self.alive.append(self.name)
        self._theirs.send({"status": "ok", "message": None})

    def receive(self) -> Any:
        return self.pipe.recv()

    def overrun(self, _: float) -> None:
        return None

    def doing(self) -> tuple[None, float]:
        return None, 0.0

    def stop(self, _: float = 0.0) -> None:
        self.alive.remove(self.name)
        self.pipe.close()
        self._theirs.close()


@pytest.fixture
def processes(monkeypatch: pytest.MonkeyPatch) -> type[Process]:
    class Fresh(Process):
        alive: list[str] = []  # noqa: RUF012 - one list a test
        begun: list[tuple[str, tuple[str, ...]]] = []  # noqa: RUF012

    monkeypatch.setattr(engine, "_child", lambda *_: Fresh())
    return Fresh


def made(combinations: list[Combination], left: RemainingTime, *ahead: Combination) -> list[str]:
    limits = ReconstructionLimits(3, 60.0, 1000)
    scene: Any = None
    running = run_reconstructions(
        scene, in_groups(combinations), limits, lambda _: None, left, ahead
    )
    return [combination.detector for combination, _, _ in running]


def test_on_a_busy_machine_one_after_the_other_is_made(processes: type[Process]) -> None:
    processes.share = 0.4
    assert made(RANKED, RemainingTime(FAR)) == ["ORB", "SIFT", "AKAZE", "STAR"]
    assert processes.begun == [(each.detector, ()) for each in RANKED]


def test_free_cores_are_used(processes: type[Process]) -> None:
    assert sorted(made(RANKED, RemainingTime(FAR))) == ["AKAZE", "ORB", "SIFT", "STAR"]
    assert processes.begun[:3] == [("ORB", ()), ("SIFT", ("ORB",)), ("AKAZE", ("ORB", "SIFT"))]


def test_without_a_deadline_a_busy_machine_is_none_of_our_business(
    processes: type[Process],
) -> None:
    processes.share = 0.1
    assert sorted(made(RANKED, RemainingTime(math.inf))) == ["AKAZE", "ORB", "SIFT", "STAR"]
    assert processes.begun[2] == ("AKAZE", ("ORB", "SIFT"))


def test_no_model_is_begun_that_would_not_be_finished(processes: type[Process]) -> None:
    """Each takes 10 s of the 25 s: the third would need 5 s more."""
    processes.share = 0.4
    clock = 0.0

    def now() -> float:
        return clock

    left = RemainingTime(25.0, now)
    limits = ReconstructionLimits(3, 60.0, 1000)
    scene: Any = None
    finished = []
    for combination, _, _ in run_reconstructions(
        scene, in_groups(RANKED), limits, lambda _: None, left
    ):
        finished.append(combination.detector)
        clock += 10.0
    assert finished == ["ORB", "SIFT"]
    assert [name for name, _ in processes.begun] == finished


@pytest.mark.parametrize(("share", "matched"), [(0.4, 1), (1.0, 2)])
def test_beside_colmaps_default_the_leader_is_matched(
    processes: type[Process], share: float, matched: int
) -> None:
    processes.share = share
    assert made([BASELINE], RemainingTime(FAR), *RANKED) == ["COLMAP"]
    names = [name for name, _ in processes.begun]
    assert names[: 1 + matched] == ["COLMAP", "matches of ORB", "matches of SIFT"][: 1 + matched]
    assert processes.alive == []


def test_colmaps_default_tells_nothing_of_the_time_of_others(processes: type[Process]) -> None:
    left = RemainingTime(FAR)
    made([BASELINE], left, RANKED[0])
    assert left.needed is None
    made(RANKED[:1], left)
    assert left.needed == pytest.approx(20.0)  # matched before, and made
