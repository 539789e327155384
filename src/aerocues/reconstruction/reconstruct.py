"""The complete reconstruction: from a scene and combinations to a folder of models."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from pathlib import Path

from aerocues.datasets.dataset import Dataset
from aerocues.errors import ReconstructionError, StoreError
from aerocues.methods.combination import Combination
from aerocues.methods.selection import Patterns
from aerocues.phrases import printable
from aerocues.progress import Progress
from aerocues.reconstruction.baseline import baseline_problem
from aerocues.reconstruction.calibration import told_calibration, with_calibrated
from aerocues.reconstruction.colmap import colmap_version
from aerocues.reconstruction.engine import in_groups, run_reconstructions
from aerocues.reconstruction.images import CALIBRATABLE, require_focal_lengths
from aerocues.reconstruction.matching import remove_features
from aerocues.reconstruction.models import SETTINGS, Models, write_outcome
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.reconstruction_progress import ReconstructionProgress
from aerocues.reconstruction.remaining_time import RemainingTime
from aerocues.reconstruction.rows import Rows, finished_rows, identity_of, other_rows, write_rows
from aerocues.reconstruction.scene import Scene
from aerocues.reconstruction.scene_making import (
    check_scene,
    chosen_combinations,
    scene_of,
    with_cameras,
)
from aerocues.results.folder_lock import folder_lock
from aerocues.results.metrics import Row
from aerocues.results.reconstruction_schema import BASELINE
from aerocues.results.store import Store
from aerocues.results.versions import machine_facts, software_versions
from aerocues.results.whole_files import json_content, write_whole


def reconstruct_scene(
    dataset: Dataset,
    combinations: Patterns,
    output: Path,
    options: ReconstructionOptions,
    progress: Progress | None = None,
    store: Store | None = None,
) -> Models:
    """Reconstruct a scene with each combination; see `aerocues.reconstruct`.

    Parameters
    ----------
    store : Store, optional
        Results of the same scene, in which rows and clouds are stored, too.
    """
    check_scene(dataset)
    scene, limits = scene_of(dataset, output, options), options.limits()
    tell = ReconstructionProgress(progress)
    chosen = chosen_combinations(scene, combinations, tell)
    reference = Combination.parse(options.reference) if options.reference else None
    if (
        reference is not None
        and reference not in (BASELINE, *chosen)
        and not scene.place(reference).is_dir()
    ):
        raise _no_reference(reference)
    Models.create(output)
    with folder_lock(output):
        scene = with_cameras(scene, limits, tell)
        _Reconstruction(scene, chosen, options, tell).run(reference, store)
    return Models(output)


def _no_reference(reference: Combination) -> ReconstructionError:
    return ReconstructionError(
        f"the reference {reference} is not among the combinations; add it to them"
    )


class _Reconstruction:
    """COLMAP's default first, which calibrates the cameras; then all combinations."""

    def __init__(
        self,
        scene: Scene,
        chosen: list[Combination],
        options: ReconstructionOptions,
        tell: ReconstructionProgress,
    ) -> None:
        self._scene = scene
        self._chosen = chosen
        self._options = options
        self._tell = tell
        self._limits = options.limits()
        self._time_left = RemainingTime(self._limits.deadline)
        self._calibration: dict[str, object] = {}

    def run(self, reference: Combination | None, store: Store | None) -> None:
        """Make the models that are missing, and write the table of all models."""
        if not self._calibrates():
            require_focal_lengths(self._scene.cameras, self._scene.protocol)
        first = self._first()
        rows = self._finished(first)
        self._write_settings()
        total = len(first) + len(self._chosen)
        made = bool(first and not rows)
        if made:
            self._tell.planned(total, 0)
            rows.update(self._made(first, [group[0] for group in in_groups(self._chosen)]))
        if BASELINE in rows:  # else the deadline came before
            self._calibrate(rows[BASELINE])
        require_focal_lengths(self._scene.cameras, self._scene.protocol)
        self._write_settings()
        if not self._options.baseline:
            rows = {}
        others = other_rows(self._scene, self._chosen)
        if reference is not None and reference not in (*self._chosen, *others, *rows):
            raise _no_reference(reference)
        present = self._finished(self._chosen)
        self._time_left.learn(present)
        if present or not made:
            self._tell.planned(total, len(first) + len(present))
        rows = {**others, **rows, **present}
        try:
            for combination, row in self._made([c for c in self._chosen if c not in present]):
                rows[combination] = row
        finally:  # an interruption loses no finished work
            if reference in rows and not rows[reference].get("registered_images"):
                self._tell.without_reference(reference, str(rows[reference]["message"]))
            if rows:
                write_rows(self._scene, rows, reference, store)
        missing = [each for each in (*first, *self._chosen) if each not in rows]
        self._tell.without_time(missing, self._time_left)
        remove_features(self._scene)

    def _finished(self, combinations: list[Combination]) -> Rows:
        retry = self._options.retry_failed
        return finished_rows(self._scene, combinations, self._limits, retry_failed=retry)

    def _first(self) -> list[Combination]:
        """COLMAP's default, if it is a row of the table or calibrates the cameras."""
        if not (self._options.baseline or self._calibrates()):
            return []
        if problem := baseline_problem():
            if not self._chosen:
                raise ReconstructionError(f"{problem}; update pycolmap, or choose combinations")
            self._tell.without_baseline(problem)
            return []
        return [BASELINE]

    def _calibrates(self) -> bool:
        calibrated = self._scene.protocol.intrinsics == "calibrated"
        return calibrated and any(each.source in CALIBRATABLE for each in self._scene.cameras)

    def _calibrate(self, row: Row) -> None:
        """Take the cameras of COLMAP's default if they are certain, and say so."""
        if not self._calibrates():
            return
        groups = self._scene.cameras
        found = row.get("calibration") if row["status"] == "ok" else None
        found = found or [None] * len(groups)
        told = told_calibration(groups, found)
        self._calibration = {"cameras": found, "message": told}
        self._scene = replace(self._scene, cameras=with_calibrated(groups, found))
        self._tell.note(told)

    def _made(
        self, combinations: list[Combination], ahead: Sequence[Combination] = ()
    ) -> Iterator[tuple[Combination, Row]]:
        scene, limits, watch, left = self._scene, self._limits, self._tell.watch, self._time_left
        running = run_reconstructions(scene, in_groups(combinations), limits, watch, left, ahead)
        with contextlib.closing(running):  # an interruption ends the processes here and now
            for combination, figures, last in running:
                when = {"reconstructed_at": time.time(), "time_limit": limits.seconds}
                row = {**identity_of(scene, combination), **figures, **when}
                row["message"] = row["message"] and printable(row["message"])
                write_outcome(scene.place(combination), row)
                if last:
                    remove_features(scene, combination)
                self._tell.finished(row)
                yield combination, row

    def _write_settings(self) -> None:
        scene, source = self._scene, self._scene.dataset.source
        facts = {
            "settings_key": scene.settings_key(),
            "dataset": {
                "name": scene.dataset.name,
                "images": len(scene.dataset.images),
                "pairs": len(scene.dataset.pairs),
                "settings": dict(scene.dataset.settings),
                "source": asdict(source) if source else None,
            },
            "left_out": dict(scene.left_out),
            "preset": scene.preset,
            "protocol": asdict(scene.protocol),
            "cameras": [asdict(group) for group in scene.cameras],
            "calibration": self._calibration,
            "time_limit": self._limits.seconds,
            "versions": {**software_versions(), "pycolmap": colmap_version()},
            "machine": machine_facts(),
        }
        write_whole({scene.folder / SETTINGS: json_content(facts)})


def open_results(folder: str | Path, dataset: Dataset) -> Store:
    """The results in which to store the rows; StoreError if they have another dataset."""
    store = Store.open(Path(folder))
    names = store.plan()["dataset"].unique().to_list()
    if dataset.name not in names:
        raise StoreError(
            f"{folder} has results of {', '.join(sorted(names))}, not of {dataset.name}; "
            "reconstruct the images that they were measured on"
        )
    return store
