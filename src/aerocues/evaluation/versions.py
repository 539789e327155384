"""What measured: versions of the software and the machine."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGES = ("aerocues", "opencv-contrib-python-headless", "numpy", "scipy", "polars", "pyarrow")


def software_versions() -> dict[str, str]:
    """Versions of Python and of the packages that a measurement depends on."""
    import cv2

    found = {"python": platform.python_version(), "opencv": cv2.__version__}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed as a package"
    return found


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith(("model name", "Model")):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass  # no /proc on this system: platform knows something
    return platform.processor() or platform.machine()


def machine_name() -> str:
    """Processor and number of cores, without anything that names the owner."""
    return f"{_processor()}, {os.cpu_count()} cores"


def machine_facts() -> dict[str, str | int]:
    """The machine as it is recorded in ``run.json``."""
    import psutil

    return {
        "name": machine_name(),
        "system": f"{platform.system()} {platform.release()}",
        "architecture": platform.machine(),
        "cores": os.cpu_count() or 1,
        "memory_bytes": psutil.virtual_memory().total,
    }
