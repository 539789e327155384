"""Options of a reconstruction, and the receiver of its progress."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from aerocues.errors import ReconstructionError
from aerocues.evaluation.run import usable_cores
from aerocues.methods.combination import Combination
from aerocues.methods.presets import Preset
from aerocues.reconstruction.engine import Doing, ReconstructionLimits
from aerocues.reconstruction.protocol import ReconstructionProtocol
from aerocues.reconstruction.scene import Wanted
from aerocues.results.metrics import Row

TIME_LIMIT = 1800.0


class ReconstructionObserver:
    """Told how it goes on; the base says nothing."""

    def preparing(self, done: int, total: int) -> None:
        """`done` of `total` images are in the folder of models."""

    def left_out(self, combinations: Sequence[Combination], reason: str) -> None:
        """The images rule out some of the combinations."""

    def planned(self, total: int, present: int) -> None:
        """`present` of `total` combinations are already finished."""

    def without_reference(self, reference: Combination, reason: str) -> None:
        """The reference has no model: there are no distances between clouds."""

    def working(self, activities: Sequence[Doing]) -> None:
        """What the processes are doing, several times a second."""

    def finished(self, row: Row) -> None:
        """A combination is finished and stored."""


@dataclass(frozen=True)
class ReconstructionOptions:
    """Options besides scene and combinations.

    Parameters
    ----------
    preset : str or Preset
        Preset of the parameters of methods; with ``thesis`` pairs need not beat chance.
    protocol : ReconstructionProtocol
    wanted : Wanted
    reference : str or None
        Combination whose cloud is the reference of distances; by default the largest model.
    features : path, optional
        Folder for features, which are reused if `run` or another reconstruction stored them there.
        By default features are removed after the reconstruction.
    workers, memory_limit_mb : int or None
        Number of processes, by default one per core; memory of each, by default its share of 80 %.
    time_limit : float
        Limit of the CPU seconds of a stage.
    retry_failed : bool
        Retry reconstructions that crashed, raised an error, or exceeded the limits of time or
        memory.
    """

    preset: str | Preset = "default"
    protocol: ReconstructionProtocol = field(default_factory=ReconstructionProtocol)
    wanted: Wanted = field(default_factory=Wanted)
    reference: str | None = None
    features: str | Path | None = None
    workers: int | None = None
    memory_limit_mb: int | None = None
    time_limit: float = TIME_LIMIT
    retry_failed: bool = False

    def limits(self) -> ReconstructionLimits:
        """The limits of a process on this machine; ReconstructionError if they are invalid."""
        import psutil

        workers = usable_cores() if self.workers is None else self.workers
        if workers < 1 or self.time_limit <= 0:
            raise ReconstructionError("--workers and --time-limit must be positive")
        share = int(0.8 * psutil.virtual_memory().total / 2**20 / workers)
        return ReconstructionLimits(workers, self.time_limit, self.memory_limit_mb or share)
