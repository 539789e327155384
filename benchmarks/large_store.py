"""What reading, scoring and reporting take with many rows: the rows of a folder, many times over.

    python benchmarks/large_store.py RESULTS [--rows 1000000]

Each copy of the rows counts as further pairs of other images. Files are those that a run writes, a
detector on a pair, put together as at the end of a run. Wall seconds and the peak of the memory are
those of processes of their own.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import polars as pl

from aerocues.results.measured_results import Results
from aerocues.results.plan_table import IDENTITY_NAMES
from aerocues.results.store import Store

CODE = """
import json, resource, time
import aerocues
started = time.perf_counter()
{work}
seconds = time.perf_counter() - started
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print(json.dumps([seconds, memory]))
"""
WORK = {
    "table": "aerocues.Results({folder!r}).table()",
    "status": "aerocues.Results({folder!r}).status()",
    "score": "aerocues.score(aerocues.Results({folder!r}))",
    "report": "aerocues.write_report(aerocues.Results({folder!r}), {page!r})",
}


def multiply(results: Results, folder: Path, rows: int) -> int:
    """Write a results folder with about so many rows; how many parts it has."""
    store = Store.create(folder)
    source = results.table()
    pairs = int(source["pair"].n_unique())
    copies = max(round(rows / len(source)), 1)
    plans, parts = [], 0
    for copy in range(copies):
        ending = pl.lit(f"-{copy}")
        table = source.with_columns(
            pl.col("pair") + copy * pairs,
            *(pl.col(name) + ending for name in ("image_1", "image_2", "row_key")),
        )
        for part in table.partition_by("detector", "pair"):
            parts += 1
            part.write_parquet(folder / "parts" / f"{part['detector'][0]}-{parts}.parquet")
        plans.append(table.select(*IDENTITY_NAMES, "row_key", "settings_key"))
    store.write_plan(pl.concat(plans).with_columns(dataset_key=pl.lit("copies")))
    store.write_run(results.settings)
    return parts


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("results", type=Path)
    parser.add_argument("--rows", type=int, nargs="+", default=[100_000, 1_000_000])
    arguments = parser.parse_args()
    for rows in arguments.rows:
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place) / "results"
            parts = multiply(Results(arguments.results), folder, rows)
            began = time.perf_counter()
            with Store.create(folder).writing():
                pass
            print(
                f"{rows:,} rows in {parts:,} files, put together into "
                f"{len(Store.open(folder).parts()):,} in {time.perf_counter() - began:.1f} s",
                flush=True,
            )
            for name, work in WORK.items():
                code = CODE.format(work=work.format(folder=str(folder), page=f"{place}/page.html"))
                done = subprocess.run(
                    [sys.executable, "-c", code], check=True, capture_output=True, text=True
                )
                seconds, memory = json.loads(done.stdout.splitlines()[-1])
                print(f"  {name:7s} {seconds:7.1f} s {memory:8,.0f} MB", flush=True)


if __name__ == "__main__":
    main()
