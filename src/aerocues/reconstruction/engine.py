"""Child processes that reconstruct: one combination each, several at a time."""

from __future__ import annotations

import collections
import math
from collections.abc import Callable, Generator, Iterable, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import wait

from aerocues.errors import AerocuesError, ImageError
from aerocues.methods.combination import Combination
from aerocues.processes.child_process import ChildProcess, Loss
from aerocues.progress import Activity, Watch
from aerocues.reconstruction.matching import Links, Matching
from aerocues.reconstruction.prepared import Prepared
from aerocues.reconstruction.remaining_time import RemainingTime
from aerocues.reconstruction.scene import Scene
from aerocues.results.metrics import Row
from aerocues.results.reconstruction_schema import BASELINE

POLL_SECONDS = 0.2
SECONDS_TO_END = 5.0
Group = collections.deque[Combination]


@dataclass(frozen=True)
class ReconstructionLimits:
    """Limits of a child process.

    Parameters
    ----------
    workers : int
        Number of processes.
    seconds : float
        Limit of the CPU seconds of each of these: features of one image, matches or chance test of
        one pair, verification, mapping. Also the limit of the wall seconds that one of them may be
        idle.
    memory_limit_mb : int
        Memory of one process.
    deadline : float
        Time of `time.monotonic` after which what is not finished is given up.
    """

    workers: int
    seconds: float
    memory_limit_mb: int
    deadline: float = math.inf


def _child(scene: Scene, limits: ReconstructionLimits) -> ChildProcess:
    return ChildProcess(
        "aerocues.reconstruction.worker",
        scene,
        memory_limit_mb=limits.memory_limit_mb,
    )


def prepare_images(
    scene: Scene,
    images: Sequence[str],
    limits: ReconstructionLimits,
    progress: Callable[[int, int], None],
) -> dict[str, Prepared | str]:
    """Write images into the folder of the scene, in a child process.

    Returns
    -------
    dict of str to Prepared or str
        By name of the image; a text says why it cannot be read.

    Raises
    ------
    AerocuesError
        If the process dies.
    OSError
        If nothing can be written.
    """
    prepared: dict[str, Prepared | str] = {}
    if not images:
        return prepared
    child = _child(scene, limits)
    try:
        for image in images:
            child.send(image)
            found = child.receive()
            if isinstance(found, Exception) and not isinstance(found, ImageError):
                raise found
            if isinstance(found, Loss):
                raise AerocuesError(f"{image}: {found.message}; remove it from the folder")
            prepared[image] = str(found) if isinstance(found, ImageError) else found
            progress(len(prepared), len(images))
        child.stop(SECONDS_TO_END)
    except BaseException:
        child.stop()
        raise
    return prepared


def link_images(
    scene: Scene, combination: Combination, limits: ReconstructionLimits, watch: Watch
) -> Row:
    """Detect, describe, match and verify in a child process; the row of what it did.

    Its ``status`` is ``ok`` where pairs were verified; the files are in the combination's folder.
    """
    child = _child(scene, limits)
    try:
        child.send(Links(combination))
        found: object = None
        while found is None:
            watch([Activity(0, *child.doing())])
            if wait([child.pipe], POLL_SECONDS):
                found = child.receive()
            else:
                found = child.overrun(limits.seconds)
    finally:
        child.stop()
    return _row_of(found)


def in_groups(combinations: Iterable[Combination]) -> list[Group]:
    """Groups of combinations with the same detector and descriptor, which share features."""
    groups: dict[tuple[str, str], Group] = {}
    for each in combinations:
        groups.setdefault((each.detector, each.descriptor), collections.deque()).append(each)
    return list(groups.values())


@dataclass(eq=False)
class _Lane:
    """One process and its group of combinations, which it processes one after the other."""

    group: Group
    child: ChildProcess
    combination: Combination = field(init=False)

    def __post_init__(self) -> None:
        self.combination = self.group.popleft()
        self.child.send(self.combination)


class _Ahead:
    """Processes that match images for models that are made later."""

    def __init__(
        self,
        scene: Scene,
        limits: ReconstructionLimits,
        time_left: RemainingTime,
        combinations: Iterable[Combination],
    ) -> None:
        self._scene, self._limits, self._time_left = scene, limits, time_left
        self._waiting = collections.deque(combinations)
        self._next = self._waiting[0] if self._waiting else None
        self._busy: dict[ChildProcess, Combination] = {}

    @property
    def children(self) -> list[ChildProcess]:
        return list(self._busy)

    @property
    def awaited(self) -> bool:
        """Whether the model that comes next is not matched yet: later ones would take its time."""
        return self._time_left.limited and self._next in self._busy.values()

    def begin(self, making: Sequence[ChildProcess]) -> None:
        """Use processes that have nothing to do."""
        while self._waiting and len(making) + len(self._busy) < self._limits.workers:
            others = [*making, *self._busy]
            if self._waiting[0] != self._next and not _allowed(self._time_left, others):
                return
            combination = self._waiting.popleft()
            child = _child(self._scene, self._limits)
            child.send(Matching(combination))
            self._busy[child] = combination

    def end(self, ready: Sequence[object]) -> None:
        """Stop those that are done or take too long; making the model will say why."""
        for child, combination in list(self._busy.items()):
            if child.pipe in ready or child.overrun(self._limits.seconds):
                self._time_left.worked(combination, child.wall_seconds, made=False)
                child.stop()
                del self._busy[child]


def _allowed(time_left: RemainingTime, others: Sequence[ChildProcess]) -> bool:
    return time_left.allows(each.core_share for each in others)


def run_reconstructions(
    scene: Scene,
    groups: Sequence[Group],
    limits: ReconstructionLimits,
    watch: Watch,
    time_left: RemainingTime,
    ahead: Iterable[Combination] = (),
) -> Generator[tuple[Combination, Row, bool], None, None]:
    """Reconstruct all groups in their order, or as many as are finished before the deadline.

    Where there is a deadline, one after the other has what it needs: another is begun beside it
    only where cores are free, and only if the time left is enough. Processes that have nothing to
    do meanwhile match images for the combinations `ahead`.

    Yields
    ------
    tuple of Combination, dict, bool
        The combination, the row of its reconstruction (even if its process died), and whether it
        was the last of its group.
    """
    queue, matching = collections.deque(groups), _Ahead(scene, limits, time_left, ahead)
    lanes: list[_Lane] = []
    try:
        while (queue or lanes or matching.awaited) and time_left.left:
            making = [lane.child for lane in lanes]
            while queue and len(lanes) < limits.workers and _allowed(time_left, making):
                lanes.append(_Lane(queue.popleft(), _child(scene, limits)))
                making.append(lanes[-1].child)
            matching.begin(making)
            children = [*making, *matching.children]
            if not children:
                return  # what is left would not be finished
            watch([Activity(n, *child.doing()) for n, child in enumerate(children)])
            ready = wait([child.pipe for child in children], POLL_SECONDS)
            matching.end(ready)
            for lane in list(lanes):
                if lane.child.pipe in ready:
                    found = lane.child.receive()
                elif (found := lane.child.overrun(limits.seconds)) is None:
                    continue
                if lane.combination != BASELINE:
                    time_left.worked(lane.combination, lane.child.wall_seconds, made=True)
                lane.child.stop(0.0 if isinstance(found, Loss) else SECONDS_TO_END)
                lanes.remove(lane)
                if lane.group:
                    queue.appendleft(lane.group)
                yield lane.combination, _row_of(found), not lane.group
    finally:
        for child in (*(lane.child for lane in lanes), *matching.children):
            child.stop()


def _row_of(found: object) -> Row:
    if isinstance(found, Loss):
        return {"status": found.status, "message": found.message}
    if isinstance(found, AerocuesError):
        return {"status": "error", "message": str(found)}
    if isinstance(found, Exception):
        raise found
    assert isinstance(found, dict)
    return found
