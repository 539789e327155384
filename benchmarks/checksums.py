"""What checksums add to the time of reading many rows.

    python benchmarks/checksums.py RESULTS [--rows 1000000] [--repeats 7]

The rows of a folder are written many times over, as in large_store.py. They are then read with
checksums and without them, by turns, each time in a process of its own; the fastest counts.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

from large_store import multiply

from aerocues.results.measured_results import Results
from aerocues.results.store import Store

CODE = """
import time
from pathlib import Path
from aerocues.results.row_files import RowFiles
from aerocues.results.store import Store
import polars
if {without}:
    RowFiles.damaged = lambda files, these, decode=False: []
store = Store.open(Path({folder!r}))
started = time.perf_counter()
rows = store.rows()
print(time.perf_counter() - started)
"""


def seconds(folder: Path, *, without: bool) -> float:
    """Seconds that reading takes in a new process."""
    code = CODE.format(folder=str(folder), without=without)
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    return float(done.stdout)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("results", type=Path)
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=7)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "results"
        multiply(Results(arguments.results), folder, arguments.rows)
        with Store.create(folder).writing():
            pass
        parts = Store.open(folder).parts()
        size = sum(part.stat().st_size for part in parts)
        print(f"{arguments.rows:,} rows in {len(parts)} files, {size / 1e6:,.0f} MB", flush=True)
        taken: dict[bool, list[float]] = {False: [], True: []}
        for turn in range(2 * arguments.repeats):
            taken[bool(turn % 2)].append(seconds(folder, without=bool(turn % 2)))
        with_checksums, without = min(taken[False]), min(taken[True])
        print(
            f"with checksums {with_checksums:.2f} s, without {without:.2f} s: "
            f"{100 * (with_checksums / without - 1):+.1f} %"
        )


if __name__ == "__main__":
    main()
