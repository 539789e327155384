"""Equal footing of a run: detectors are given the thresholds that reach a number of keypoints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from aerocues.datasets.dataset import Dataset
from aerocues.errors import ArgumentError
from aerocues.evaluation.run_progress import RunProgress
from aerocues.methods.combination import Combination
from aerocues.methods.preset_files import recorded_preset
from aerocues.methods.presets import TUNED, Preset
from aerocues.methods.registry import Methods
from aerocues.methods.strongest import KeypointLimit
from aerocues.pipeline.equal_footing import at_equal_footing, told_short
from aerocues.results.store import RUN, Store


def footing_wanted(preset: Preset, limit: KeypointLimit, asked: bool | None) -> bool:
    """Whether thresholds are lowered: as asked, by default under the preset `tuned` alone.

    Raises
    ------
    ArgumentError
        If it is asked for, but there is no number to reach, or the preset keeps its thresholds.
    """
    if asked is None:
        return preset.name == TUNED and limit.count > 0
    if asked and not limit.count:
        raise ArgumentError(
            "`equal_footing` lowers thresholds until `max_keypoints` are found; give that number"
        )
    if asked and not preset.chance_test:
        raise ArgumentError(
            f"the preset {preset.name} keeps its thresholds; leave `equal_footing` out, or choose "
            "another preset"
        )
    return asked


def preset_at_footing(
    preset: Preset,
    methods: Methods,
    dataset: Dataset,
    chosen: Sequence[Combination],
    limit: KeypointLimit,
    *,
    seed: int,
    told: RunProgress,
    store: Store | None,
) -> Preset:
    """The preset with thresholds that reach the limit, also those of earlier runs in the folder.

    Parameters
    ----------
    preset, chosen, limit, seed
        As of the run.
    methods : Methods
        With the parameters of `preset`.
    dataset : Dataset
        Its middle image is looked at.
    told : RunProgress
        Detectors that cannot reach the limit are named.
    store : Store or None
        Results folder, which may hold rows of detectors that this run does not choose.

    Raises
    ------
    ImageError
        If no image can be read.
    """
    changed, footings = at_equal_footing(
        methods, preset, dataset.images, chosen, limit, seed=seed, progress=told.thresholds
    )
    if short := told_short(footings):
        told.note(short)
    facts = store.run() if store and (store.folder / RUN).is_file() else {}
    images = facts.get("dataset", {})
    if (images.get("name"), facts.get("preset")) != (dataset.name, changed.name):
        return changed
    return replace(changed, detectors={**recorded_preset(facts).detectors, **changed.detectors})
