"""What checksums add to the time of reading many rows.

    python benchmarks/checksums.py RESULTS [--rows 1000000] [--repeats 7]

The rows of a folder are written many times over, into files of the size that a long run puts
together. They are then read with checksums and without them, by turns, each time in a process of
its own; the fastest of each counts. CPU seconds are steadier on a machine that does other work.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import polars as pl

from aerocues.results.measured_results import Results
from aerocues.results.row_files import RowFiles
from aerocues.results.store import PARTS, Store

ROWS_OF_A_FILE = 20_000
CODE = """
import time
from pathlib import Path
from aerocues.results.row_files import RowFiles
from aerocues.results.store import Store
import polars
if {without}:
    RowFiles.damaged = lambda files, these, decode=False: []
store = Store.open(Path({folder!r}))
started, used = time.perf_counter(), time.process_time()
rows = store.rows()
print(time.perf_counter() - started, time.process_time() - used)
"""


def write_copies(rows: pl.DataFrame, folder: Path, count: int) -> list[Path]:
    """Write so many rows, each with a key and a time of its own; the files."""
    files = RowFiles(folder / PARTS)
    copies = pl.concat([rows] * (ROWS_OF_A_FILE // len(rows) + 1)).head(ROWS_OF_A_FILE)
    generator = np.random.default_rng(0)
    for number in range(count // ROWS_OF_A_FILE):
        keys = [generator.bytes(16).hex() for _ in range(len(copies))]
        times = [
            pl.col(name) * pl.Series(generator.uniform(0.9, 1.1, len(copies)))
            for name in copies.columns
            if name.endswith(("_seconds", "_seconds_1", "_seconds_2", "_cpu"))
        ]
        files.write(f"together-{number}", copies.with_columns(*times, row_key=pl.Series(keys)))
    return files.files()


def seconds(folder: Path, *, without: bool) -> tuple[float, ...]:
    """Wall and CPU seconds that reading takes in a new process."""
    code = CODE.format(folder=str(folder), without=without)
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    return tuple(map(float, done.stdout.split()))


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("results", type=Path)
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=7)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "results"
        rows = Results(arguments.results).table()
        Store.create(folder).write_run({})
        parts = write_copies(rows, folder, arguments.rows)
        size = sum(part.stat().st_size for part in parts)
        print(f"{arguments.rows:,} rows in {len(parts)} files, {size / 1e6:,.0f} MB", flush=True)
        taken: dict[bool, list[tuple[float, ...]]] = {False: [], True: []}
        for turn in range(2 * arguments.repeats):
            taken[bool(turn % 2)].append(seconds(folder, without=bool(turn % 2)))
        fastest = zip(
            *([min(times) for times in zip(*taken[w], strict=True)] for w in taken), strict=True
        )
        for what, (with_checksums, without) in zip(("wall", "CPU"), fastest, strict=True):
            print(
                f"{what}: with checksums {with_checksums:.2f} s, without {without:.2f} s, "
                f"{100 * (with_checksums / without - 1):+.1f} %"
            )


if __name__ == "__main__":
    main()
