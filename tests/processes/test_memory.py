"""The memory of containers counts, where it is less than the machine's."""

from __future__ import annotations

from pathlib import Path

import psutil
import pytest

from aerocues.processes import memory
from aerocues.processes.limits import share_of_memory, worker_count


@pytest.fixture
def mounted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(memory, "GROUPS", tmp_path / "cgroup")
    monkeypatch.setattr(memory, "MOUNTED", tmp_path / "mounted")
    return tmp_path / "mounted"


def write(mounted: Path, groups: str, limits: dict[str, str]) -> None:
    memory.GROUPS.write_text(groups)
    for name, text in limits.items():
        (mounted / name).parent.mkdir(parents=True, exist_ok=True)
        (mounted / name).write_text(f"{text}\n")


def test_without_groups_it_is_that_of_the_machine(mounted: Path) -> None:
    assert memory.memory_bytes() == psutil.virtual_memory().total


@pytest.mark.parametrize(
    ("groups", "limits"),
    [
        ("0::/user/job\n", {"user/memory.max": "max", "user/job/memory.max": "1073741824"}),
        ("0::/user/job\n", {"user/memory.max": "1073741824", "user/job/memory.max": "max"}),
        ("0::/seen/from/outside\n", {"memory.max": "1073741824"}),
        (
            "5:cpu,memory:/job\n1:cpuset:/x\n0::/\n",
            {
                "memory/job/memory.limit_in_bytes": "1073741824",
                "memory/memory.limit_in_bytes": "9223372036854771712",
            },
        ),
    ],
)
def test_the_least_limit_of_the_groups_counts(
    mounted: Path, groups: str, limits: dict[str, str]
) -> None:
    write(mounted, groups, limits)
    assert memory.memory_bytes() == 2**30
    assert share_of_memory(1) == 819
    assert worker_count(None) == 1
    assert worker_count(3) == 3
