"""What a full evaluation costs: against a naive loop, one pass with brute force, and bare calls.

    python benchmarks/evaluation.py [--dataset simulated:FLIGHT] [--max-pairs 6] [--max-width 400]

Four figures, each of the same combinations on the same pairs, in processes of their own:

- quality: the first pass of a run, with exact search in place of brute force, on one worker and
  on two;
- shared: one pass with OpenCV's brute force, on one worker, as `--timing shared` makes it;
- bare: the calls that cannot be avoided (decode, detect and describe once, match exactly or by
  FLANN, verify, verify shuffled matches) in a plain loop;
- naive: what the stages of the shared pass took, with every combination detecting and describing
  both images of each pair for itself.

TBMR stays out: it may end the process of the plain loop.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

COMBINATIONS = "*,!TBMR-*"
SHUFFLES = 5
RUN = """
import json, resource, time
import aerocues
started = time.perf_counter()
dataset = aerocues.open_dataset({dataset!r}, max_pairs={max_pairs}, max_width={max_width})
results = aerocues.run(
    dataset, {combinations!r}, {output!r}, workers={workers}, timing={timing!r}
)
wall = time.perf_counter() - started
cpu = sum(
    usage.ru_utime + usage.ru_stime
    for usage in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
)
table = results.table().fill_null(0)
stages = [name for name in table.columns if name.endswith("_cpu")]
naive = sum(
    float(table[name].sum()) * (1 + {shuffles} if name.startswith("verify") else 1)
    for name in stages
)
print(json.dumps({{"wall": wall, "cpu": cpu, "rows": len(table), "naive": naive}}))
"""
LOOP = """
import json, sys
sys.path.insert(0, {folder!r})
from bare_loop import BareLoop
loop = BareLoop({dataset!r}, {max_pairs}, naive=False, exact=True, max_width={max_width})
print(json.dumps({{"cpu": loop.run({combinations!r})}}))
"""
Figures = dict[str, float]


def _measure(code: str) -> Figures:
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    found: Figures = json.loads(done.stdout.splitlines()[-1])
    return found


def _run(arguments: argparse.Namespace, timing: str, workers: int) -> Figures:
    with tempfile.TemporaryDirectory() as output:
        words = {**vars(arguments), "timing": timing, "workers": workers, "shuffles": SHUFFLES}
        return _measure(RUN.format(**words, output=f"{output}/results"))


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--dataset", default="synthetic")
    parser.add_argument("--max-pairs", type=int, default=6, help="pairs")
    parser.add_argument("--max-width", type=int, default=400, help="pixels")
    parser.add_argument("--combinations", default=COMBINATIONS)
    arguments = parser.parse_args()
    bare = _measure(LOOP.format(**vars(arguments), folder=str(Path(__file__).parent)))
    print(f"bare       {bare['cpu']:8.1f} s CPU", flush=True)
    one = _run(arguments, "estimated", 1)
    print(f"quality    {one['cpu']:8.1f} s CPU, {one['wall']:.1f} s wall, {one['rows']:,} rows")
    two = _run(arguments, "estimated", 2)
    print(f"  2 workers{two['cpu']:8.1f} s CPU, {two['wall']:.1f} s wall", flush=True)
    shared = _run(arguments, "shared", 1)
    print(f"shared     {shared['cpu']:8.1f} s CPU, {shared['wall']:.1f} s wall")
    print(f"naive      {shared['naive']:8.1f} s CPU")
    for what, ratio in (
        ("naive / quality", shared["naive"] / one["cpu"]),
        ("shared / quality", shared["cpu"] / one["cpu"]),
        ("quality / bare", one["cpu"] / bare["cpu"]),
        ("wall of 1 worker / wall of 2", one["wall"] / two["wall"]),
    ):
        print(f"{what:29s} {ratio:6.2f}")


if __name__ == "__main__":
    main()
