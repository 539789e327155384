"""Third-party methods that go wrong on one image, each in its own way.

They find and describe what OpenCV's ORB does, unless the image has the mark in its corner. Where
the environment variable says so they are healthy: the run without a fault to compare with.
"""

from __future__ import annotations

import mmap
import os
import signal
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from aerocues.methods.arrays import Features, Keypoints, Matches

MARK = (1, 254, 3)
HEALTHY = "AEROCUES_TEST_HEALTHY"
GATE = "gate"
Image = NDArray[np.uint8]


def mark(image: Image) -> None:
    """Make `image` the one on which the methods below go wrong."""
    image[:4, :4] = MARK


def is_marked(image: Image) -> bool:
    return HEALTHY not in os.environ and tuple(image[0, 0]) == MARK


def segfault() -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


def leave() -> None:
    os._exit(3)


def sleep() -> None:
    time.sleep(10_000)


def burn() -> None:
    while True:
        pass


def allocate() -> None:
    np.ones((200_000, 100_000))


def grow() -> None:
    kept = []
    while True:
        kept.append(np.ones(2_000_000))


def grow_shared() -> None:
    """Beyond the reach of a limit on a process's own data: its parent has to notice."""
    kept = []
    while True:
        kept.append(mmap.mmap(-1, 16 << 20))
        kept[-1].write(b"x" * (16 << 20))


def fail() -> None:
    raise ValueError("this image is not to my taste")


def fail_in_opencv() -> None:
    cv2.cvtColor(np.zeros((2, 2), np.uint8), cv2.COLOR_BGR2GRAY)


def fail_strangely() -> None:
    raise KeyboardInterrupt


def kill_parent() -> None:
    """As a system does that is short of memory: the process that started this one goes, too."""
    time.sleep(1)
    os.kill(os.getppid(), signal.SIGKILL)
    time.sleep(10)


def do_nothing() -> None:
    pass


def wait() -> bool:
    """No fault: it takes until the test makes a file, and then does what it should."""
    while not (Path(os.environ["AEROCUES_TEST_RUN"]) / GATE).exists():
        time.sleep(0.02)
    return True


FAULTS: dict[str, Callable[[], bool | None]] = {
    "SEGFAULT": segfault,
    "LEAVE": leave,
    "SLEEP": sleep,
    "BURN": burn,
    "ALLOCATE": allocate,
    "GROW": grow,
    "GROW_SHARED": grow_shared,
    "FAIL": fail,
    "CV2": fail_in_opencv,
    "STRANGE": fail_strangely,
    "NONSENSE": do_nothing,
    "KILL_PARENT": kill_parent,
    "PATIENT": wait,
}


class FaultyDetector:
    """A detector of a given kind of fault."""

    def __init__(self, fault: str) -> None:
        self.fault = fault
        self.native: Any = cv2.ORB_create(200)

    def detect(self, image: Image) -> Any:
        if is_marked(image) and not FAULTS[self.fault]():
            return [1, 2, 3]
        return Keypoints.from_opencv(self.native.detect(image))


class FaultyDescriptor:
    """A descriptor of a given kind of fault."""

    dtype = "uint8"

    def __init__(self, fault: str) -> None:
        self.fault = fault
        self.native: Any = cv2.ORB_create(200)

    def describe(self, image: Image, keypoints: Keypoints) -> Any:
        if is_marked(image) and not FAULTS[self.fault]():
            return Features(keypoints, np.zeros((len(keypoints), 32), np.float32))
        native, rows = self.native.compute(image, keypoints.to_opencv())
        return Features(Keypoints.from_opencv(native), rows)


class FaultyMatcher:
    """A matcher that goes wrong where a descriptor row of the marked image is all zeros."""

    dtypes = {"HAM": ("uint8",)}  # noqa: RUF012 - as the guide tells third parties to write it

    def match(self, features_1: Features, features_2: Features, norm: str) -> Matches:
        if HEALTHY not in os.environ:
            segfault()
        count = min(len(features_1), len(features_2))
        pairs = np.repeat(np.arange(count, dtype=np.int32)[:, None], 2, axis=1)
        return Matches(pairs, np.zeros(count, np.float32))


def _factory(kind: type, fault: str) -> Any:
    class Made(kind):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__(fault)

    return Made


def __getattr__(name: str) -> Any:
    """``Detector_SEGFAULT`` and the like, which entry points name."""
    kind, _, fault = name.partition("_")
    if fault in FAULTS and kind in ("Detector", "Descriptor"):
        return _factory(FaultyDetector if kind == "Detector" else FaultyDescriptor, fault)
    raise AttributeError(name)


def entry_points(names: Sequence[str]) -> dict[str, dict[str, str]]:
    """What a distribution of faulty methods offers; a descriptor's name begins with ``D_``."""
    here = __name__
    return {
        "detectors": {name: f"{here}:Detector_{name}" for name in names if name in FAULTS},
        "descriptors": {
            name: f"{here}:Descriptor_{name[2:]}" for name in names if name.startswith("D_")
        },
        "matchers": {name: f"{here}:FaultyMatcher" for name in names if name == "KILLER"},
    }


def workers_of(token: str) -> set[int]:
    """Ids of the worker processes whose environment holds `token`, orphans included."""
    found = set()
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            is_worker = b"aerocues.evaluation.worker" in (folder / "cmdline").read_bytes()
            if is_worker and token.encode() in (folder / "environ").read_bytes():
                found.add(int(folder.name))
        except OSError:
            continue
    return found
