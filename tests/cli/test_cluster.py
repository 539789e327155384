"""`aerocues run --engine dask`: what is said where it cannot be, and of several machines."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import polars as pl
import pytest

from aerocues.cli.cluster import machine_lines
from aerocues.cli.progress import PlainLines
from aerocues.progress import Event
from tests.cli.conftest import Call
from tests.evaluation.cluster import Cluster

RUN = ("--combinations", "ORB-ORB-HAM-BF", "--max-pairs", "1")


@pytest.fixture
def output(tmp_path: Path) -> Path:
    return tmp_path / "results"


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--engine", "dask"), "--scheduler tcp://HOST:8786"),
        (("--scheduler", "tcp://host:8786"), "--engine dask"),
        (("--resource", "board"), "--engine dask"),
        (("--engine", "dask", "--scheduler", "tcp://h:1", "--workers", "2"), "--workers"),
        (("--engine", "slurm"), "'slurm'"),
    ],
)
def test_options_that_do_not_go_together(
    call: Call, photos: Path, output: Path, options: tuple[str, ...], words: str
) -> None:
    answer = call("run", photos, "-o", output, *RUN, *options)
    assert answer.code == 2
    assert words in answer.err
    assert answer.err.count("\n") == 1
    assert not output.exists()


@pytest.mark.parametrize(
    "address", ["tcp://127.0.0.1:1", "nonsense", "ftp://host:1", "tcp://host:x"]
)
def test_no_scheduler_is_told_in_one_line(
    call: Call, photos: Path, output: Path, address: str
) -> None:
    pytest.importorskip("distributed")
    answer = call("run", photos, "-o", output, *RUN, "--engine", "dask", "--scheduler", address)
    assert answer.code == 2
    assert answer.err.startswith("error: ")
    assert address in answer.err
    assert "dask scheduler" in answer.err
    assert answer.err.count("\n") == 1
    assert not output.exists()


def test_without_distributed_the_extra_is_named(
    call: Call, photos: Path, output: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    options = ("--engine", "dask", "--scheduler", "tcp://127.0.0.1:1")
    answer = call("run", photos, "-o", output, *RUN, *options)
    assert answer.code == 2
    assert "pip install 'aerocues[dask]'" in answer.err


def test_several_kinds_of_machine_are_named() -> None:
    table = pl.DataFrame({"machine": ["board", "laptop", "board", None]})
    assert machine_lines(table) == ["machines 2 rows on board; 1 row on laptop"]
    assert machine_lines(table.head(1)) == []


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    """A scheduler with a worker on its way."""
    pytest.importorskip("distributed")
    made = Cluster(tmp_path)
    try:
        made.start()
        made.add_worker()
        yield made
    finally:
        made.stop()


@pytest.mark.slow
def test_a_run_on_a_cluster(call: Call, photos: Path, output: Path, cluster: Cluster) -> None:
    options = ("--engine", "dask", "--scheduler", cluster.address)
    answer = call("run", photos, "-o", output, *RUN, *options)
    assert answer.code == 0, answer.err
    assert "dashboard http://127.0.0.1:" in answer.err
    assert "rows     1: ok 1" in answer.out


@pytest.mark.slow
def test_a_missing_resource_is_told(
    call: Call,
    photos: Path,
    output: Path,
    cluster: Cluster,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    address = cluster.address
    options = ("--engine", "dask", "--scheduler", address, "--resource", "board")
    tell = PlainLines.__call__

    def add_one_once_told(lines: PlainLines, event: Event) -> None:
        tell(lines, event)
        if len(cluster.workers) == 1 and any(each.waiting_for for each in event.workers):
            cluster.add_worker("--no-nanny", "--resources", "board=1")

    monkeypatch.setattr(PlainLines, "__call__", add_one_once_told)
    answer = call("run", photos, "-o", output, *RUN, *options)
    assert answer.code == 0, answer.err
    assert f"'dask worker {address} --nthreads 1 --resources board=1'" in answer.err
    assert "waiting for a worker with the resource board, " in answer.err
    assert "rows     1: ok 1" in answer.out
