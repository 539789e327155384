"""What the Dask engine does where workers are missing or die at once, without a cluster."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("distributed")

from distributed import KilledWorker

from aerocues.datasets.dataset import Dataset
from aerocues.evaluation import dask_engine
from aerocues.evaluation.dask_engine import DaskEngine
from aerocues.evaluation.run import run
from aerocues.evaluation.unit import Unit
from aerocues.progress import Event

ADDRESS = "tcp://board:4000"


@dataclass
class DeadlyTask:
    """A future whose workers die before they tell anything, as soon as there are any."""

    key: str
    workers: dict[str, dict[str, Any]]

    def done(self) -> bool:
        return any(worker["resources"] for worker in self.workers.values())

    def result(self, timeout: float) -> None:
        last: Any = SimpleNamespace(address=ADDRESS)
        raise KilledWorker(self.key, last, 3)


@dataclass
class DeadlyCluster:
    """What the engine uses of a client."""

    workers: dict[str, dict[str, Any]] = field(default_factory=dict)
    units: list[Unit] = field(default_factory=list)
    status: str = "running"

    def add_worker(self, nthreads: int, **resources: float) -> None:
        address = f"tcp://host:{len(self.workers)}"
        self.workers[address] = {"nthreads": nthreads, "resources": resources}

    def nthreads(self) -> dict[str, int]:
        return {address: worker["nthreads"] for address, worker in self.workers.items()}

    def scheduler_info(self, n_workers: int) -> dict[str, Any]:
        assert n_workers == -1
        return {"workers": self.workers}

    def submit(self, *task: Any, key: str, **_: object) -> DeadlyTask:
        self.units.append(task[-1])
        return DeadlyTask(key, self.workers)

    def ignore(self, *_: object, **__: object) -> None:
        """What is said to the cluster beside the units."""

    register_plugin = subscribe_topic = cancel = ignore
    unsubscribe_topic = unregister_worker_plugin = ignore


@pytest.fixture
def client() -> Any:
    return DeadlyCluster()


def test_only_what_workers_have_of_the_resource_counts(client: Any) -> None:
    client.add_worker(4)
    client.add_worker(4, board=1)
    client.add_worker(1, board=2)
    client.add_worker(2, board=0.5)
    assert DaskEngine(client).threads == 11
    assert DaskEngine(client, resource="board").threads == 2
    assert DaskEngine(client, resource="nobody").threads == 0


def test_waiting_for_a_worker_is_told_until_one_comes(
    client: Any, views: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dask_engine, "SECONDS_BETWEEN_COUNTS", 0.0)
    monkeypatch.setattr(dask_engine, "POLL_SECONDS", 0.0)
    client.add_worker(4)
    told: list[str] = []

    def wait(event: Event) -> None:
        told.extend(activity.waiting_for for activity in event.workers if not event.rows)
        if len(told) == 3:
            client.add_worker(1, board=1)

    engine = DaskEngine(client, resource="board")
    run(views, "ORB-ORB-HAM-BF", tmp_path, timing="shared", engine=engine, progress=wait)
    assert told == ["a worker with the resource board"] * 3


def test_a_unit_whose_workers_die_without_a_word_is_given_up(
    client: Any, views: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dask_engine, "POLL_SECONDS", 0.0)
    client.add_worker(1, board=1)
    table = run(
        views, "ORB-ORB-HAM-*", tmp_path, timing="shared", engine=DaskEngine(client)
    ).table()
    assert table["status"].to_list() == ["crashed"] * 6
    [message] = set(table["message"])
    assert message.startswith("12 Dask workers ")
    assert ADDRESS in message
    assert set(table["machine"]) == {"board"}
    # The unit of 3 pairs, each of them alone, and the two that are left of it: 3 times each.
    assert len(client.units) == 3 * 5
