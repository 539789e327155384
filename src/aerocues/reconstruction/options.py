"""Options of a reconstruction."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

from aerocues.arguments import seconds_of
from aerocues.defaults import STAGE_TIMEOUT
from aerocues.methods.presets import Preset
from aerocues.processes.limits import memory_mb, share_of_memory, worker_count
from aerocues.reconstruction.engine import ReconstructionLimits
from aerocues.reconstruction.protocol import ReconstructionProtocol
from aerocues.reconstruction.scene import Wanted


@dataclass(frozen=True)
class ReconstructionOptions:
    """Options besides scene and combinations; see `aerocues.reconstruct`.

    Parameters
    ----------
    preset : str or Preset
        Preset of the parameters of methods; with ``thesis`` pairs need not beat chance.
    protocol : ReconstructionProtocol
    refine_keypoints : bool or None
        Whether keypoints of tracks are refined; None: unless the preset takes keypoints as OpenCV
        gives them, as ``thesis`` does.
    wanted : Wanted
    reference : str or None
        Combination whose cloud is the reference of distances; by default the best model.
    features : path, optional
        Folder for features, which are reused if `run` or another reconstruction stored them there.
        By default features are removed after the reconstruction.
    workers : int or None
        Number of processes; by default one per core.
    timeout : float or str
        Limit of the CPU time of a stage.
    memory_limit : float or None
        Gigabytes of each process; by default its share of 80 %.
    baseline : bool
        Whether COLMAP's default is a row of the table, too.
    deadline : float
        Time of `time.monotonic` after which nothing is made any more; never by default.
    retry_failed : bool
        Retry reconstructions that crashed, raised an error, or exceeded a limit.

    Raises
    ------
    ArgumentError
        If a limit is invalid.
    """

    preset: str | Preset = "default"
    protocol: ReconstructionProtocol = field(default_factory=ReconstructionProtocol)
    refine_keypoints: bool | None = None
    wanted: Wanted = field(default_factory=Wanted)
    reference: str | None = None
    features: str | Path | None = None
    workers: int | None = None
    timeout: float | str = STAGE_TIMEOUT
    memory_limit: float | None = None
    baseline: bool = True
    deadline: float = math.inf
    retry_failed: bool = False

    def __post_init__(self) -> None:
        self.limits()

    def limits(self) -> ReconstructionLimits:
        """The limits of a process on this machine."""
        workers = worker_count(self.workers)
        memory = memory_mb(self.memory_limit) or share_of_memory(workers)
        seconds = seconds_of("timeout", self.timeout)
        return ReconstructionLimits(workers, seconds, memory, self.deadline)
