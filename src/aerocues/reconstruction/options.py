"""What may be chosen of a reconstruction."""

from __future__ import annotations

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
    """What may be chosen besides scene and combinations; see `aerocues.reconstruct`.

    Parameters
    ----------
    preset : str or Preset
        Preset of the parameters of methods; with ``thesis`` pairs need not beat chance.
    protocol : ReconstructionProtocol
    wanted : Wanted
    reference : str or None
        Combination whose cloud is the reference of distances; by default the largest model.
    features : path, optional
        Folder in which features are kept, and found if `run` or another reconstruction kept them
        there; by default they are kept for the time of the reconstruction only.
    workers : int or None
        Processes at a time; one a core by default.
    timeout : float or str
        CPU time of a stage.
    memory_limit : float or None
        Gigabytes of each process; its share of 80 % by default.
    retry_failed : bool
        Try again what crashed, raised an error, or ran out of time or memory.

    Raises
    ------
    ArgumentError
        If a limit makes no sense.
    """

    preset: str | Preset = "default"
    protocol: ReconstructionProtocol = field(default_factory=ReconstructionProtocol)
    wanted: Wanted = field(default_factory=Wanted)
    reference: str | None = None
    features: str | Path | None = None
    workers: int | None = None
    timeout: float | str = STAGE_TIMEOUT
    memory_limit: float | None = None
    retry_failed: bool = False

    def __post_init__(self) -> None:
        self.limits()

    def limits(self) -> ReconstructionLimits:
        """The limits of a process on this machine."""
        workers = worker_count(self.workers)
        memory = memory_mb(self.memory_limit) or share_of_memory(workers)
        return ReconstructionLimits(workers, seconds_of("timeout", self.timeout), memory)
