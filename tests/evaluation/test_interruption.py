"""Runs that are killed, and disks that are full or closed."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from aerocues.errors import StoreError
from aerocues.evaluation import run as running
from aerocues.results.export import export_table
from aerocues.results.measured_results import Results
from tests.evaluation.faults import workers_of
from tests.evaluation.inline import InlineEngine
from tests.evaluation.scenes import assert_same_rows, dataset_of, rows_of, strip, write_dataset
from tests.waiting import wait_until

# Times are not the point: each pair is measured once.
run = partial(running.run, timing="shared")
COMBINATIONS = "ORB-*-HAM-BF,SIFT-SIFT-L2-BF,AKAZE-AKAZE-HAM-*,!*-BOOST-*"
SCRIPT = """
import sys
from pathlib import Path
from aerocues.evaluation.run import run
from tests.evaluation.scenes import dataset_of

images, results, combinations = sys.argv[1:]
dataset = dataset_of(Path(images), sorted(path.name for path in Path(images).iterdir()))
run(dataset, combinations, results, timing="shared", workers=2, timeout=60)
"""


def start(images: Path, results: Path) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-c", SCRIPT, str(images), str(results), COMBINATIONS],
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
            "AEROCUES_TEST_RUN": str(images),
            "TMPDIR": str(results.parent),
        },
        stderr=subprocess.PIPE,
        start_new_session=True,
    )


def parts_of(results: Path) -> int:
    return len(list((results / "parts").glob("*.parquet")))


def _has(results: Path, parts: int, process: subprocess.Popen[bytes]) -> bool:
    return parts_of(results) >= parts or process.poll() is not None


@pytest.mark.slow
def test_killed_twice_and_resumed_equals_an_undisturbed_run(tmp_path: Path) -> None:
    images, results = tmp_path / "images", tmp_path / "results"
    dataset = write_dataset(images, strip(5))
    for kill in range(2):
        process = start(images, results)
        enough = parts_of(results) + 2 + kill
        wait_until(partial(_has, results, enough, process))
        assert process.poll() is None, process.stderr and process.stderr.read()
        process.send_signal(signal.SIGKILL)
        process.wait()
        wait_until(lambda: not workers_of(str(images)))
        assert not list(tmp_path.glob("aerocues-worker-*"))
        before = parts_of(results)
        assert before >= enough
        assert Results(results).status().left
    last = start(images, results)
    assert last.wait() == 0, last.stderr and last.stderr.read()
    undisturbed = run(dataset, COMBINATIONS, tmp_path / "undisturbed", engine=InlineEngine())
    assert_same_rows(rows_of(Results(results).table()), rows_of(undisturbed.table()))
    assert Results(results).status().left == 0
    assert not list(results.rglob("*.tmp"))


@pytest.mark.slow
def test_ending_the_whole_process_group_leaves_no_temporary_folder(tmp_path: Path) -> None:
    images, results = tmp_path / "images", tmp_path / "results"
    write_dataset(images, strip(5))
    process = start(images, results)
    wait_until(partial(_has, results, 1, process))
    assert list(tmp_path.glob("aerocues-worker-*"))
    os.killpg(process.pid, signal.SIGTERM)
    assert process.wait() == -signal.SIGTERM
    wait_until(lambda: not workers_of(str(images)))
    assert not list(tmp_path.glob("aerocues-worker-*"))


def mount(folder: Path, *options: str) -> None:
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", ",".join(options), "tmpfs", str(folder)]
    try:
        done = subprocess.run(command, capture_output=True, check=False)
    except OSError as error:
        pytest.skip(f"no mount command: {error}")
    if done.returncode:
        pytest.skip(f"mounting is not permitted here: {done.stderr.decode().strip()}")


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 256 KiB."""
    folder = tmp_path / "disk"
    mount(folder, "size=256k")
    yield folder
    subprocess.run(["umount", "-l", str(folder)], check=False)


@pytest.fixture
def closed_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system that can only be read."""
    folder = tmp_path / "closed"
    mount(folder, "size=64k", "ro")
    yield folder
    subprocess.run(["umount", "-l", str(folder)], check=False)


@pytest.mark.slow
def test_a_full_disk_keeps_what_was_finished(tmp_path: Path, small_disk: Path) -> None:
    dataset = write_dataset(tmp_path / "images", strip(4))
    combinations = "ORB-ORB-HAM-*,ORB-BRIEF-HAM-BF,FAST-ORB-HAM-BF"
    ballast = small_disk / "ballast"
    results = small_disk / "results"
    first = run(dataset, "ORB-ORB-HAM-BF", results, engine=InlineEngine())
    kept = rows_of(first.table())
    free = shutil.disk_usage(small_disk).free
    ballast.write_bytes(b"x" * max(free - 16_000, 0))
    with pytest.raises(StoreError, match=str(results)):
        run(dataset, combinations, results, engine=InlineEngine())
    (small_disk / "more").write_bytes(b"x" * shutil.disk_usage(small_disk).free)
    with pytest.raises(StoreError, match=r"table\.csv.*No space left"):
        export_table(first.table(), small_disk / "table.csv", "csv")
    assert not list(results.rglob("*.tmp"))
    assert Results(results).status().planned >= 3
    ballast.unlink()
    (small_disk / "more").unlink()
    again = run(dataset, "ORB-ORB-HAM-BF", results, engine=InlineEngine())
    assert {name: row for name, row in rows_of(again.table()).items() if name in kept} == kept
    complete = run(dataset, combinations, tmp_path / "elsewhere", engine=InlineEngine())
    resumed = run(dataset, combinations, results, engine=InlineEngine())
    assert_same_rows(rows_of(resumed.table()), rows_of(complete.table()))


def test_a_folder_that_cannot_be_written_is_an_error(tmp_path: Path, closed_disk: Path) -> None:
    dataset = write_dataset(tmp_path / "images", strip(2))
    with pytest.raises(StoreError, match="Read-only"):
        run(dataset, "ORB-ORB-HAM-BF", closed_disk / "results", engine=InlineEngine())


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="needs a folder that nobody can write")
def test_a_folder_of_the_system_is_an_error(tmp_path: Path) -> None:
    dataset = write_dataset(tmp_path / "images", strip(2))
    with pytest.raises(StoreError, match="/proc"):
        run(dataset, "ORB-ORB-HAM-BF", "/proc/aerocues", engine=InlineEngine())


@pytest.mark.slow
def test_an_interrupted_run_resumes_where_it_was(tmp_path: Path) -> None:
    """An engine that stops half-way, as Ctrl-C would: finished units stay."""
    write_dataset(tmp_path / "images", strip(4))
    dataset = dataset_of(tmp_path / "images", [f"view_{i}.png" for i in range(4)])

    class Stopping(InlineEngine):
        def run(self, *arguments: object) -> Iterator[object]:  # type: ignore[override]
            for count, finished in enumerate(super().run(*arguments)):  # type: ignore[arg-type]
                if count == 2:
                    raise KeyboardInterrupt
                yield finished

    combinations = "ORB-ORB-HAM-BF,SIFT-SIFT-L2-BF,AKAZE-AKAZE-HAM-BF"
    with pytest.raises(KeyboardInterrupt):
        run(dataset, combinations, tmp_path / "r", engine=Stopping())  # type: ignore[arg-type]
    done = len(Results(tmp_path / "r").table())
    assert 0 < done < 9
    assert Results(tmp_path / "r").status().left == 9 - done
    resumed = run(dataset, combinations, tmp_path / "r", engine=InlineEngine())
    undisturbed = run(dataset, combinations, tmp_path / "u", engine=InlineEngine())
    assert_same_rows(rows_of(resumed.table()), rows_of(undisturbed.table()))
