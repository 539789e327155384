"""What a Dask cluster costs and gains, against worker processes on the same machine.

    python benchmarks/cluster.py [--dataset DATASET] [--max-pairs PAIRS] [--repeats N]

Wall seconds of the same job with one and two local workers, and with one and two Dask workers on a
scheduler of their own, all on this machine. Starting the scheduler and the workers is not counted;
starting the processes that measure is, as each run does it. The variants take turns, so that a
change of the machine's speed meets all alike. With Dask, the client and the scheduler want some of
the cores that the workers use.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import aerocues
from aerocues import Dataset
from aerocues.evaluation.dask_engine import DaskEngine
from aerocues.evaluation.dask_scheduler import connected
from aerocues.evaluation.engine import Engine

# Many units of like size: what each worker adds, not what the longest unit allows.
COMBINATIONS = "ORB-ORB-HAM-FLANN,AKAZE-AKAZE-HAM-FLANN,BRISK-BRISK-HAM-FLANN,SIFT-SIFT-L2-FLANN"


@contextlib.contextmanager
def cluster(workers: int) -> Iterator[Engine]:
    """A scheduler and workers as separate processes, ready to work."""
    program = [sys.executable, "-m"]
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as processes:
        file = Path(folder) / "scheduler.json"
        place = ["--host", "127.0.0.1", "--scheduler-file", str(file)]
        ports = ["--port", "0", "--dashboard-address", "127.0.0.1:0"]
        commands = [[*program, "distributed.cli.dask_scheduler", *place, *ports]]
        options = ["--nthreads", "1", "--no-dashboard", "--local-directory", folder]
        commands += [[*program, "distributed.cli.dask_worker", *place, *options]] * workers
        for command in commands:
            quiet = subprocess.DEVNULL
            processes.callback(_end, subprocess.Popen(command, stdout=quiet, stderr=quiet))
            while not file.exists():
                time.sleep(0.1)
        with connected(json.loads(file.read_text())["address"]) as client:
            client.wait_for_workers(workers, timeout=60)
            yield DaskEngine(client)


def _end(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    process.wait()


def measure(dataset: Dataset, workers: int, engine: Engine | None) -> float:
    """Wall seconds of the job."""
    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        place = f"{folder}/results"
        options = {"timing": "shared", "workers": None if engine else workers, "engine": engine}
        aerocues.run(dataset, COMBINATIONS, place, **options)
        return time.perf_counter() - started


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--dataset", default="synthetic")
    parser.add_argument("--max-pairs", type=int, default=4, help="pairs")
    parser.add_argument("--repeats", type=int, default=3)
    arguments = parser.parse_args()
    dataset = aerocues.open_dataset(arguments.dataset, max_pairs=arguments.max_pairs)
    seconds: dict[str, list[float]] = {}
    for _ in range(arguments.repeats):
        for workers in (1, 2):
            local = measure(dataset, workers, None)
            with cluster(workers) as engine:
                dask = measure(dataset, workers, engine)
            seconds.setdefault(f"local, {workers} workers", []).append(local)
            seconds.setdefault(f"Dask,  {workers} workers", []).append(dask)
            print(f"{workers} workers: local {local:.1f} s, Dask {dask:.1f} s", flush=True)
    for name, figures in seconds.items():
        spread = f"{min(figures):.1f} to {max(figures):.1f}"
        print(f"{name}: median {statistics.median(figures):.1f} s ({spread})")


if __name__ == "__main__":
    main()
