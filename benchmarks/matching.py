"""Exact matching against OpenCV's brute force and faiss, side by side on one core.

    python benchmarks/matching.py [--sizes 5000 10000 20000 30000] [--kinds ...] [--repeats 3]

Descriptors are real ones of FAST keypoints in two pictures of the embedded dataset, in random
order. Prints a row a kind and size: seconds of each (the median of the repeats; brute force, which
needs minutes, is timed once where it takes longer than ten seconds), how many times ours is faster,
the rise of memory in our call, and whether its matches equal those of brute force bit for bit.
faiss is left out where it is not installed (pip install faiss-cpu).
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import time
from collections.abc import Callable
from functools import cache
from typing import Any

import cv2
import numpy as np

import aerocues
from aerocues.methods.arrays import Features, Matches
from aerocues.methods.exact.matching import mutual_nearest
from aerocues.methods.making import make_descriptor, make_detector, make_matcher
from aerocues.methods.parameters import Value
from aerocues.methods.presets import Preset
from aerocues.methods.registry import Methods, opencv_methods
from aerocues.pipeline.clock import Clock
from aerocues.processes.child_process import ONE_THREAD

# Descriptor, norm and parameters that differ from the thesis's, of each kind.
KINDS: dict[str, tuple[str, str, dict[str, Value]]] = {
    "256 bits": ("ORB", "HAM", {}),
    "512 bits": ("BEBLID", "HAM", {}),
    "SIFT": ("SIFT", "L2", {}),
    "DAISY": ("DAISY", "L2", {}),
    "VGG": ("VGG", "L2", {}),
}
SIZES = (5_000, 10_000, 20_000, 30_000)
LONG = 10.0
Timed = tuple[float, Any]


@cache
def _pictures(width: int) -> list[Any]:
    """Two views of the embedded picture, large enough for the most keypoints."""
    dataset = aerocues.open_dataset("synthetic")
    pair = dataset.pairs[0]
    views = [dataset.image(name).read().bgr for name in (pair.image_1, pair.image_2)]
    return [cv2.resize(view, (width, width * len(view) // view.shape[1])) for view in views]


def described(kind: str, count: int, width: int) -> list[Features]:
    """`count` descriptors of each of two pictures."""
    name, _, parameters = KINDS[kind]
    fast = {"threshold": 1, "type": "FastFeatureDetector.TYPE_9_16"}
    preset = Preset("bench", "", True, {"FAST": fast}, {name: parameters} if parameters else {})
    methods = opencv_methods().with_preset(preset)
    return [_some(methods, name, picture, count) for picture in _pictures(width)]


def _some(methods: Methods, name: str, picture: Any, count: int) -> Features:
    detector, descriptor = make_detector(methods, "FAST"), make_descriptor(methods, name, "FAST")
    keypoints = detector.read(detector.call(picture))
    order = np.random.default_rng(0).permutation(len(keypoints))
    few = keypoints.take(order[: int(1.3 * count)])
    found = descriptor.read(descriptor.call(picture, descriptor.prepare(few, picture)))
    if len(found) < count:
        raise SystemExit(f"{name} describes {len(found):,} keypoints only; give a larger --width")
    kept = np.random.default_rng(1).permutation(len(found))[:count]
    return Features(found.keypoints.take(kept), np.ascontiguousarray(found.descriptors[kept]))


def timed(call: Callable[[], Any], repeats: int) -> Timed:
    """Median CPU seconds, and what the last call returned; long calls are made once."""
    seconds: list[float] = []
    result = None
    while len(seconds) < repeats and (not seconds or seconds[-1] < LONG):
        began = time.process_time()
        result = call()
        seconds.append(time.process_time() - began)
    return statistics.median(seconds), result


def by_faiss(first: Any, second: Any) -> Callable[[], Any] | None:
    """Mutual nearest neighbours by faiss, on one thread; None where it is not installed."""
    try:
        import faiss
    except ImportError:
        return None
    faiss.omp_set_num_threads(1)

    def index(rows: Any) -> Any:
        bits = rows.dtype == np.uint8
        columns = rows.shape[1]
        made = faiss.IndexBinaryFlat(8 * columns) if bits else faiss.IndexFlatL2(columns)
        made.add(rows)
        return made

    def match() -> Any:
        forth = index(second).search(first, 1)[1][:, 0]
        back = index(first).search(second, 1)[1][:, 0]
        rows = np.flatnonzero(back[forth] == np.arange(len(forth)))
        return np.stack([rows, forth[rows]], axis=1)

    return match


def row(kind: str, count: int, width: int, repeats: int) -> str:
    """One line of the table."""
    _, norm, _ = KINDS[kind]
    first, second = described(kind, count, width)
    small = [
        Features(each.keypoints.take(np.arange(64)), each.descriptors[:64])
        for each in (first, second)
    ]
    mutual_nearest(*small, norm)
    ours, matches = timed(lambda: mutual_nearest(first, second, norm), repeats)
    _, memory = Clock(exclusive=True).time(lambda: mutual_nearest(first, second, norm))
    brute_force = make_matcher(opencv_methods(), "BF", norm)
    theirs, raw = timed(lambda: brute_force.call(first, second), repeats)
    expected: Matches = brute_force.read(raw)
    same = np.array_equal(expected.indices, matches.indices) and np.array_equal(
        expected.distance, matches.distance
    )
    call = by_faiss(first.descriptors, second.descriptors)
    other = timed(call, repeats)[0] if call else None
    return (
        f"{kind:9s} {count:7,d} {theirs:9.3f} {'-' if other is None else f'{other:.3f}':>9s} "
        f"{ours:9.3f} {theirs / ours:8.1f}x "
        f"{'-' if other is None else f'{other / ours:.1f}x':>9s} "
        f"{memory.peak_memory or float('nan'):7.0f}  {'yes' if same else 'NO'}"
    )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES)
    parser.add_argument("--kinds", nargs="+", default=list(KINDS), choices=list(KINDS))
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--width", type=int, default=1600, help="of the pictures, pixels")
    arguments = parser.parse_args()
    if not ONE_THREAD.items() <= os.environ.items():  # numpy looks at them when it is imported
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **ONE_THREAD})
    cv2.setNumThreads(1)
    print("                   CPU seconds                   ours is faster      MB  same")
    print("kind            N        BF     faiss      ours   than BF     faiss")
    for kind in arguments.kinds:
        for count in arguments.sizes:
            print(row(kind, count, arguments.width, arguments.repeats), flush=True)


if __name__ == "__main__":
    main()
