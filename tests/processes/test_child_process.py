from __future__ import annotations

from pathlib import Path

import pytest

from aerocues.errors import EngineError
from aerocues.processes.child_process import ChildProcess


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="threads are counted in /proc")
def test_products_of_matrices_stay_on_one_core(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "4")
    child = ChildProcess("tests.evaluation.threads_child", None, memory_limit_mb=2000)
    try:
        # Itself and the watch over its parent.
        assert child.receive() == 2
    finally:
        child.stop()


def test_of_a_child_that_cannot_start_the_last_line_is_told() -> None:
    with pytest.raises(EngineError, match=r"\w+Error\b[^/]*`memory_limit`"):
        ChildProcess("tests.evaluation.threads_child", None, memory_limit_mb=1)
