"""Versions of the software, and the machine."""

from __future__ import annotations

import contextlib
import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGES = (
    "aerocues",
    "opencv-contrib-python-headless",
    "opencv-contrib-python",
    "opencv-python-headless",
    "opencv-python",
    "numpy",
    "scipy",
    "polars",
    "pyarrow",
)
# The name of a board. All Jetsons of a generation have the same text in /proc/cpuinfo.
BOARD = Path("/proc/device-tree/model")

CORES = Path("/sys/devices/system/cpu")


def software_versions() -> dict[str, str]:
    """Versions of Python, of OpenCV (from cv2 itself), and of the installed packages.

    OpenCV from the system of a board is not a Python package, and the light install has no pyarrow.
    """
    import cv2

    found = {"python": platform.python_version(), "opencv": cv2.__version__}
    for name in PACKAGES:
        with contextlib.suppress(PackageNotFoundError):
            found[name] = version(name)
    return found


def _processor() -> str:
    with contextlib.suppress(OSError):  # not a board, or a phone that does not reveal it
        board = BOARD.read_text(errors="replace").strip("\0 \n")
        if board:
            return board
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith(("model name", "Model")):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass  # this system has no /proc: platform knows something
    return platform.processor() or platform.machine()


def machine_name() -> str:
    """Board or processor and number of cores, without anything that identifies the owner."""
    return f"{_processor()}, {os.cpu_count()} cores"


def _governors() -> str:
    """The frequency governor of the cores, such as ``performance``; empty if unknown."""
    found = set()
    for file in CORES.glob("cpu[0-9]*/cpufreq/scaling_governor"):
        with contextlib.suppress(OSError):
            found.add(file.read_text().strip())
    return ", ".join(sorted(found))


def machine_facts() -> dict[str, str | int]:
    """The machine as recorded in ``run.json``, with its frequency governor if known."""
    import psutil

    governors = _governors()
    return {
        **({"governor": governors} if governors else {}),
        "name": machine_name(),
        "system": f"{platform.system()} {platform.release()}",
        "architecture": platform.machine(),
        "cores": os.cpu_count() or 1,
        "memory_bytes": psutil.virtual_memory().total,
    }
