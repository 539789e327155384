"""One model from images to a judgement, in the folder of its combination."""

from __future__ import annotations

import shutil
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from aerocues.methods.combination import Combination
from aerocues.pipeline.feature_source import Announce
from aerocues.pipeline.features import StageError
from aerocues.pipeline.pair_stages import stage_call
from aerocues.reconstruction.diagnosis import Outcome, without_model
from aerocues.reconstruction.exports import MODEL, PLY, TEXT, UNDISTORTED
from aerocues.reconstruction.judging import CLOUD, PICTURE, judge
from aerocues.reconstruction.matched_scene import Names
from aerocues.reconstruction.scene import Scene
from aerocues.results.metrics import Row

Result = TypeVar("Result")
DATABASE = "database.db"
OUTCOME = "outcome.json"
MAPPING = "mapping"
STAGES = ("feature", "matching", "verification", "mapping")
OPTIONAL_STAGE = "refinement"


@dataclass(frozen=True)
class Linked:
    """The verified pairs: inliers of each, and COLMAP's numbers of the images."""

    inliers: Mapping[Names, int]
    numbers: Mapping[str, int]


class ModelMaker(ABC):
    """Makes one model; what differs between features of ours and of COLMAP is left to be said.

    Parameters
    ----------
    scene : Scene
    combination : Combination
        Names the model and its folder.
    announce : callable
        Told of each stage before it begins.
    """

    def __init__(self, scene: Scene, combination: Combination, announce: Announce) -> None:
        self.scene = scene
        self.combination = combination
        self.announce = announce
        self.folder = scene.place(combination)
        self.row: Row = {}
        self._stage = "matching"

    @abstractmethod
    def link(self) -> Linked | Outcome:
        """Put verified pairs into the database, or say why there are none."""

    @abstractmethod
    def map(self) -> list[Any]:
        """Models from the database, the largest first."""

    def figures(self, model: Any) -> Row:
        """What only models of one kind tell."""
        return {}

    def make(self) -> Row:
        """The row of the reconstruction, with its status, as far as it came."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self._remove_earlier()
        self.row["images"] = len(self.scene.dataset.images)
        try:
            outcome = self._reconstruct()
        except StageError as failure:
            outcome = Outcome(failure.status, failure.message)
        except (RuntimeError, ValueError, KeyError, IndexError) as error:  # what COLMAP raises
            text = " ".join(str(error).split())
            outcome = Outcome("error", f"{self._stage}: {type(error).__name__}: {text}")
        times = [f"{stage}_seconds" for stage in STAGES]
        if all(name in self.row for name in times):
            optional = self.row.get(f"{OPTIONAL_STAGE}_seconds", 0.0)
            self.row["reconstruction_seconds"] = sum(self.row[name] for name in times) + optional
        return {**self.row, "status": outcome.status, "message": outcome.message}

    def timed(self, stage: str, call: Callable[[], Result]) -> Result:
        """Do a part of a stage of the whole scene and note its CPU seconds."""
        self._stage = stage
        images = f"{len(self.scene.dataset.images)} images"
        self.announce(stage_call(stage, self.combination, images))
        begun = time.process_time()
        found = call()
        seconds = f"{stage}_seconds"
        self.row[seconds] = self.row.get(seconds, 0.0) + time.process_time() - begun
        return found

    def _remove_earlier(self) -> None:
        """Take away what was made under other settings; matches say themselves what they are of.

        The outcome first: nothing may vouch for files that are on their way out.
        """
        (self.folder / OUTCOME).unlink(missing_ok=True)
        for file in (CLOUD, PICTURE, PLY):
            (self.folder / file).unlink(missing_ok=True)
        for folder in (MODEL, TEXT, UNDISTORTED, MAPPING):
            shutil.rmtree(self.folder / folder, ignore_errors=True)
        for left_over in self.folder.glob("*.tmp"):
            left_over.unlink()

    def _reconstruct(self) -> Outcome:
        linked = self.link()
        if isinstance(linked, Outcome):
            return linked
        models = self.timed("mapping", self.map)
        self.row["components"] = len(models)
        if not models:
            return without_model(self.folder / DATABASE, linked.inliers, linked.numbers)
        self._stage = "judging"
        self.announce(stage_call("judging", self.combination, "its model"))
        figures, outcome = judge(models[0], self.scene, self.combination, linked.inliers)
        self.row.update({**figures, **self.figures(models[0])})
        return outcome
