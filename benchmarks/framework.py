"""What the framework costs and what it saves, against bare loops over the same OpenCV calls.

Three figures on the embedded dataset (or any other):

- overhead: CPU seconds of a run with one worker over those of a bare loop that makes the same
  calls (decode, detect, describe, match, verify, verify shuffled matches, homography), once each;
- speed-up: wall seconds with one worker over those with two, on more pairs with cheap descriptors:
  what many units of work gain, not what the longest one allows;
- saving: CPU seconds of a naive loop, in which every combination detects and describes for
  itself, over those of the run.

Each is measured `--repeats` times in turn, so that a change of the machine's speed meets all alike.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

# All meaningful combinations of four detectors, as a full evaluation has them.
COMBINATIONS = "AKAZE-*,MSER-*,GFTT_H-*,MSD-*"
EVEN = {
    "combinations": "ORB-ORB-HAM-*,AKAZE-AKAZE-*,AKAZE-SIFT-*,BRISK-BRISK-HAM-*,SIFT-SIFT-*",
    "max_pairs": 8,
}
RUN = """
import json, sys, time, resource
import aerocues
started = time.perf_counter()
dataset = aerocues.open_dataset({dataset!r}, max_pairs={max_pairs})
results = aerocues.run(dataset, {combinations!r}, {output!r}, workers={workers}, timing="shared")
wall = time.perf_counter() - started
cpu = sum(
    usage.ru_utime + usage.ru_stime
    for usage in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
)
print(json.dumps({{"wall": wall, "cpu": cpu, "rows": len(results.table())}}))
"""
LOOP = """
import json, sys, time
sys.path.insert(0, {folder!r})
from bare_loop import BareLoop
loop = BareLoop({dataset!r}, {max_pairs}, naive={naive})
print(json.dumps({{"cpu": loop.run({combinations!r})}}))
"""


def _measure(code: str) -> dict[str, float]:
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    found: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return found


def _run(arguments: argparse.Namespace, workers: int) -> dict[str, float]:
    with tempfile.TemporaryDirectory() as output:
        return _measure(RUN.format(**vars(arguments), workers=workers, output=f"{output}/results"))


def _loop(arguments: argparse.Namespace, *, naive: bool) -> dict[str, float]:
    folder = str(Path(__file__).parent)
    return _measure(LOOP.format(**vars(arguments), naive=naive, folder=folder))


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--dataset", default="synthetic")
    parser.add_argument("--max-pairs", type=int, default=1, help="pairs")
    parser.add_argument("--combinations", default=COMBINATIONS)
    parser.add_argument("--repeats", type=int, default=3)
    arguments = parser.parse_args()
    overhead, speed_up, saving = [], [], []
    for _ in range(arguments.repeats):
        bare = _loop(arguments, naive=False)
        whole = _run(arguments, 1)
        naive = _loop(arguments, naive=True)
        even = argparse.Namespace(**vars(arguments) | EVEN)
        one, two = _run(even, 1), _run(even, 2)
        overhead.append(whole["cpu"] / bare["cpu"])
        saving.append(naive["cpu"] / whole["cpu"])
        speed_up.append(one["wall"] / two["wall"])
        print(
            f"{whole['rows']:.0f} rows: bare {bare['cpu']:.1f} s, run {whole['cpu']:.1f} s, "
            f"naive {naive['cpu']:.1f} s CPU; {one['rows']:.0f} rows: one worker "
            f"{one['wall']:.1f} s, two {two['wall']:.1f} s",
            flush=True,
        )
    for name, figures in (
        ("overhead (CPU of the run / bare calls)", overhead),
        ("speed-up from 1 to 2 workers (wall)", speed_up),
        ("saving (CPU of the naive loop / run)", saving),
    ):
        spread = f"{min(figures):.3f} to {max(figures):.3f}"
        print(f"{name}: median {statistics.median(figures):.3f} ({spread})")


if __name__ == "__main__":
    main()
