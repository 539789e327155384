"""What scoring costs: the bootstrap of a full evaluation, against scoring each resample by itself.

Tables of random values, 466 alternatives x 8 criteria, with 40 and with 1000 repeats; 1000
resamples, weights estimated anew in each. Memory is the peak of the process beyond its imports.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys

CODE = """
import json, resource, time
from dataclasses import replace
import numpy as np
from scipy.stats import rankdata
from aerocues.scoring import Criterion, DecisionTable, score
from aerocues.scoring.bootstrap import bootstrap
values = np.random.default_rng(0).lognormal(size=(466, {repeats}, 8))
table = DecisionTable(
    alternatives=tuple(map(str, range(466))),
    repeats=tuple(map(str, range({repeats}))),
    criteria=tuple(Criterion(f"c{{n}}", "lower" if n > 5 else "higher") for n in range(8)),
    values=values,
    failed=np.zeros(values.shape, dtype=bool),
    blocks=np.zeros({repeats}, dtype=np.int64),
)
scores = score(table)
rankdata(scores.scores)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
started = time.perf_counter()
bootstrap(scores, {resamples})
seconds = time.perf_counter() - started
memory = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
generator, loop = np.random.default_rng(0), {loop}
started = time.perf_counter()
for _ in range(loop):
    drawn = generator.integers({repeats}, size={repeats})
    score(replace(table, values=values[:, drawn], failed=table.failed[:, drawn]))
each = (time.perf_counter() - started) / loop
print(json.dumps({{"seconds": seconds, "memory": memory, "one_by_one": each * {resamples}}}))
"""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--resamples", type=int, default=1000)
    arguments = parser.parse_args()
    for repeats, loop in ((40, 20), (1000, 3)):
        code = CODE.format(repeats=repeats, resamples=arguments.resamples, loop=loop)
        rounds = []
        for _ in range(arguments.rounds):
            done = subprocess.run(
                [sys.executable, "-c", code], check=True, capture_output=True, text=True
            )
            rounds.append(json.loads(done.stdout))
        seconds = [each["seconds"] for each in rounds]
        print(
            f"{repeats} repeats: median {statistics.median(seconds):.2f} s ({min(seconds):.2f} to "
            f"{max(seconds):.2f}), {max(each['memory'] for each in rounds):.0f} MB more; one by "
            f"one {statistics.median(each['one_by_one'] for each in rounds):.1f} s (extrapolated)"
        )


if __name__ == "__main__":
    main()
