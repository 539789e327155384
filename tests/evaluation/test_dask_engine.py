"""Units on a Dask cluster of separate processes: the same rows, whatever becomes of workers."""

from __future__ import annotations

import dataclasses
import functools
import re
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest

pytest.importorskip("distributed")

from aerocues.datasets.dataset import Dataset
from aerocues.errors import EngineError
from aerocues.evaluation import dask_worker
from aerocues.evaluation import run as running
from aerocues.evaluation.dask_engine import DaskEngine
from aerocues.evaluation.dask_scheduler import connected
from aerocues.progress import Event
from aerocues.results.measured_results import Results
from aerocues.results.store import Store
from aerocues.results.versions import software_versions
from tests.evaluation.cluster import Cluster
from tests.evaluation.faults import GATE, HEALTHY, entry_points, mark, workers_of
from tests.evaluation.inline import InlineEngine
from tests.evaluation.scenes import PLAIN, Rows, assert_same_rows, rows_of, strip, write_dataset
from tests.methods.distribution import write_distribution
from tests.waiting import wait_until

# One pass over all pairs, on all workers at once.
run = functools.partial(running.run, timing="shared", preset=PLAIN)
FEW = "ORB-ORB-HAM-*,SIFT-SIFT-L2-BF"
# Some rows at once; others not before the test lets them.
PATIENT = "PATIENT-ORB-HAM-BF,ORB-ORB-HAM-BF"
LIMITS: dict[str, Any] = {"timeout": 8, "memory_limit": 700 / 1024}
pytestmark = pytest.mark.slow


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    """A scheduler that has no worker yet."""
    made = Cluster(tmp_path)
    try:
        made.start()
        yield made
    finally:
        made.stop()
    wait_until(lambda: not workers_of(str(tmp_path)))


class During:
    """Calls a function once when `rows` rows are there and a worker is at work."""

    def __init__(self, action: Callable[[], None], rows: int = 1) -> None:
        self.action: Callable[[], None] | None = action
        self.left = rows

    def __call__(self, event: Event) -> None:
        self.left -= len(event.rows)
        working = any(activity.call for activity in event.workers)
        if self.action and self.left <= 0 and working and not event.rows:
            action, self.action = self.action, None
            action()


def test_rows_equal_those_of_the_local_engine(
    cluster: Cluster, views: Dataset, tmp_path: Path
) -> None:
    cluster.add_worker()
    cluster.add_worker()
    with connected(cluster.address) as client:
        assert DaskEngine(client).dashboard
        words: dict[str, Any] = {"preset": "default", "engine": DaskEngine(client)}
        results = run(views, FEW, tmp_path / "dask", **words)
        again = run(views, FEW, tmp_path / "dask", **words)
    local = run(views, FEW, tmp_path / "local", preset="default", workers=1)
    assert_same_rows(rows_of(results.table()), rows_of(local.table()))
    assert len(Store(again.folder).rows()) == len(local.table())
    assert results.table()["machine"].to_list() == local.table()["machine"].to_list()


def test_rows_of_long_units_come_pair_by_pair(
    cluster: Cluster, views: Dataset, tmp_path: Path
) -> None:
    cluster.add_worker()
    with connected(cluster.address) as client:
        engine = DaskEngine(client, longest_seconds=0)
        results = run(views, FEW, tmp_path / "dask", engine=engine)
    local = run(views, FEW, tmp_path / "local", engine=InlineEngine())
    assert_same_rows(rows_of(results.table()), rows_of(local.table()))


@pytest.fixture
def faulty(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Dataset:
    """Five views; methods that some of the tests install go wrong on the third."""
    names = ["SEGFAULT", "D_SLEEP", "FAIL", "KILL_PARENT", "PATIENT"]
    write_distribution(tmp_path / "site", "faults", entry_points(names), {})
    monkeypatch.syspath_prepend(tmp_path / "site")
    pictures = strip(5)
    mark(pictures["view_2.png"])
    return write_dataset(tmp_path / "images", pictures)


@pytest.fixture
def healthy(
    faulty: Dataset, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> Callable[[str], Rows]:
    """The rows of combinations where nothing goes wrong."""

    def measure(combinations: str) -> Rows:
        with monkeypatch.context() as patch:
            patch.setenv(HEALTHY, "1")
            results = run(faulty, combinations, tmp_path / "healthy", engine=InlineEngine())
            return rows_of(results.table())

    return measure


def test_workers_that_die_and_one_that_comes_late(
    cluster: Cluster, faulty: Dataset, healthy: Callable[[str], Rows], tmp_path: Path
) -> None:
    first = [cluster.add_worker() for _ in range(2)]
    with connected(cluster.address) as client:
        client.wait_for_workers(2)
        known = set(client.nthreads())

        def kill_one_and_add_one() -> None:
            first[0].send_signal(signal.SIGKILL)
            cluster.add_worker()
            wait_until(lambda: set(client.nthreads()) - known)
            # The late one has to do the rest.
            first[1].send_signal(signal.SIGKILL)
            (tmp_path / GATE).touch()

        observer = During(kill_one_and_add_one)
        engine = DaskEngine(client, longest_seconds=0)
        results = run(faulty, PATIENT, tmp_path / "r", engine=engine, progress=observer)
    assert observer.action is None
    assert_same_rows(rows_of(results.table()), healthy(PATIENT))


def test_an_interruption_keeps_what_was_finished_and_ends_processes(
    cluster: Cluster, faulty: Dataset, healthy: Callable[[str], Rows], tmp_path: Path
) -> None:
    cluster.add_worker()

    def interrupt() -> None:
        raise KeyboardInterrupt

    with connected(cluster.address) as client:
        engine = DaskEngine(client, longest_seconds=0)
        with pytest.raises(KeyboardInterrupt):
            run(faulty, PATIENT, tmp_path / "r", engine=engine, progress=During(interrupt))
        wait_until(lambda: not workers_of(str(tmp_path)))
        kept = Results(tmp_path / "r").status()
        assert 0 < kept.planned - kept.left < kept.planned
        (tmp_path / GATE).touch()
        results = run(faulty, PATIENT, tmp_path / "r", engine=engine)
    assert_same_rows(rows_of(results.table()), healthy(PATIENT))


def test_a_lost_scheduler_is_an_error(cluster: Cluster, faulty: Dataset, tmp_path: Path) -> None:
    cluster.add_worker()
    observer = During(cluster.kill_scheduler)
    with connected(cluster.address) as client:
        engine = DaskEngine(client, longest_seconds=0)
        with pytest.raises(EngineError, match="scheduler"):
            run(faulty, PATIENT, tmp_path / "r", engine=engine, progress=observer)
    assert len(Results(tmp_path / "r").table())


def test_faults_are_recorded_as_by_the_local_engine(
    cluster: Cluster, faulty: Dataset, tmp_path: Path
) -> None:
    cluster.add_worker()
    dataset = dataclasses.replace(faulty, pairs=faulty.pairs[:2])
    combinations = "SEGFAULT-ORB-HAM-BF,ORB-D_SLEEP-HAM-BF,FAIL-ORB-HAM-BF,ORB-ORB-HAM-*"
    with connected(cluster.address) as client:
        engine = DaskEngine(client, **LIMITS)
        results = run(dataset, combinations, tmp_path / "dask", engine=engine)
    local = run(dataset, combinations, tmp_path / "local", workers=1, **LIMITS)
    assert {"crashed", "timeout", "error", "ok"} <= set(local.table()["status"])
    assert_same_rows(rows_of(results.table()), rows_of(local.table()))


def test_what_takes_workers_down_is_named(
    faulty: Dataset, healthy: Callable[[str], Rows], tmp_path: Path
) -> None:
    strict = Cluster(tmp_path, {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1"})
    combinations = "KILL_PARENT-ORB-HAM-BF,ORB-ORB-HAM-BF"
    try:
        strict.start()
        for _ in range(2):
            strict.add_worker("--nanny")
        with connected(strict.address) as client:
            rows = rows_of(
                run(faulty, combinations, tmp_path / "dask", engine=DaskEngine(client)).table()
            )
    finally:
        strict.stop()
    expected = healthy(combinations)
    guilty = {n for n, r in rows.items() if r["detector"] == "KILL_PARENT" and r["pair"] in (1, 2)}
    for name in guilty:
        assert rows[name]["status"] == "crashed"
        # How many depends on whether they could report it before they died.
        assert re.match(r"\d+ Dask workers died in ", str(rows[name]["message"]))
    assert_same_rows(
        {name: row for name, row in rows.items() if name not in guilty},
        {name: row for name, row in expected.items() if name not in guilty},
    )


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (Path.unlink, r"view_1\.png.*mount"),
        (lambda path: path.write_bytes(b"other"), r"view_1\.png"),
    ],
)
def test_a_worker_without_the_images_is_an_error(
    cluster: Cluster, tmp_path: Path, change: Callable[[Path], object], words: str
) -> None:
    """The file changes after it was read here, as if it were never like that at the worker."""
    dataset = write_dataset(tmp_path / "images", strip(2))
    cluster.add_worker()

    def change_once(event: Event) -> None:
        if event.stage == "measuring" and event.message:
            change(tmp_path / "images" / "view_1.png")

    with (
        connected(cluster.address) as client,
        pytest.raises(EngineError, match=words),
    ):
        run(dataset, FEW, tmp_path / "r", engine=DaskEngine(client), progress=change_once)


def test_a_worker_with_other_versions_is_an_error(
    cluster: Cluster, views: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cluster.add_worker()
    versions = software_versions() | {"opencv": "4.0"}
    monkeypatch.setattr(dask_worker, "software_versions", lambda: versions)
    with (
        connected(cluster.address) as client,
        pytest.raises(EngineError, match=r"opencv .*\b4\.0\b"),
    ):
        run(views, FEW, tmp_path / "r", engine=DaskEngine(client))


def test_exclusive_times_of_one_machine_are_taken_one_at_a_time(
    cluster: Cluster, views: Dataset, tmp_path: Path
) -> None:
    cluster.add_worker()
    cluster.add_worker()
    with connected(cluster.address) as client:
        client.wait_for_workers(2)
        engine = DaskEngine(client)
        combinations = "ORB-ORB-HAM-*,FAST-ORB-HAM-BF,BRISK-BRISK-HAM-BF,AKAZE-AKAZE-HAM-BF"
        table = run(views, combinations, tmp_path / "r", timing="exclusive", engine=engine).table()
    assert set(table["timing"]) == {"exclusive"}
    assert table["peak_memory_mb"].null_count() < len(table)
    # Each detector was a unit: the times at which its rows were begun lie together.
    times = table.sort("measured_at")["detector"].rle()
    assert len(times) == table["detector"].n_unique()


def test_only_workers_with_the_resource_are_used(
    cluster: Cluster, views: Dataset, tmp_path: Path
) -> None:
    plain = cluster.add_worker()
    used: list[psutil.Process] = []
    told: list[str] = []

    def add_one(event: Event) -> None:
        told.extend(activity.waiting_for for activity in event.workers)
        if event.workers and len(cluster.workers) == 1:
            cluster.add_worker("--no-nanny", "--resources", "board=1")
        if event.rows:
            used.extend(psutil.Process(plain.pid).children())

    with connected(cluster.address) as client:
        client.wait_for_workers(1)
        engine = DaskEngine(client, resource="board")
        assert engine.threads == 0
        results = run(views, FEW, tmp_path / "r", engine=engine, progress=add_one)
    assert len(results.table()) == 9
    assert used == []
    assert told[0] == "a worker with the resource board"
