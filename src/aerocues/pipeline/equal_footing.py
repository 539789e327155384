"""Equal footing: thresholds of detectors are lowered until they reach a number of keypoints.

A comparison at unequal numbers of keypoints compares thresholds, not methods: at the threshold of
the thesis SIFT finds 808 keypoints in an image of 1000 pixels where COLMAP's default finds 3,479.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from aerocues.datasets.dataset import Image
from aerocues.datasets.decoded import DecodedSource
from aerocues.errors import ImageError, SelectionError
from aerocues.methods.combination import Combination
from aerocues.methods.detectors import DetectorRow
from aerocues.methods.parameters import Value
from aerocues.methods.presets import Preset
from aerocues.methods.registry import Methods
from aerocues.methods.strongest import KeypointLimit
from aerocues.pipeline.clock import Clock
from aerocues.pipeline.feature_source import FeatureSource
from aerocues.pipeline.features import ImageFeatures
from aerocues.pipeline.protocol import MeasurementProtocol

STEP, MOST_STEPS = 0.5, 6


@dataclass(frozen=True)
class Footing:
    """What became of one detector.

    Parameters
    ----------
    detector : str
    parameter : str or None
        Its threshold; None where it has none.
    value : int or float or None
        The threshold that is used from now on.
    steps : int
        How often it was lowered.
    keypoints : int
        That it finds in the survey image, before the strongest are chosen.
    reached : bool
        Whether that is as many as were asked for.
    """

    detector: str
    parameter: str | None
    value: Value | None
    steps: int
    keypoints: int
    reached: bool


def told_short(footings: Sequence[Footing]) -> str:
    """A sentence on the detectors that cannot reach the number; empty if all can."""
    short = [each for each in footings if each.keypoints and not each.reached]
    listed = ", ".join(f"{each.detector} {each.keypoints:,}" for each in short)
    return f"even at their lowest thresholds these find fewer keypoints: {listed}" if short else ""


def survey_image(images: Sequence[Image]) -> Image:
    """The image from which thresholds are set: the middle one, as flights begin over edges.

    Or the next one that can be read.
    """
    middle = len(images) // 2
    for image in (*images[middle:], *images[:middle]):
        try:
            image.read()
        except ImageError:
            continue  # an error of its own pairs
        return image
    return images[middle]


def at_equal_footing(
    methods: Methods,
    preset: Preset,
    images: Sequence[Image],
    combinations: Sequence[Combination],
    limit: KeypointLimit,
    *,
    seed: int = 0,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> tuple[Preset, list[Footing]]:
    """The preset with thresholds that reach the limit, for the detectors of combinations.

    A preset without a test against chance, as that of the thesis, stays what it is; so does any
    where all keypoints are kept.

    Parameters
    ----------
    methods, preset, seed, progress
        As in `reach_keypoints`.
    images : sequence of Image
        Of the dataset.
    combinations : sequence of Combination
    limit : KeypointLimit

    Raises
    ------
    ImageError
        If no image can be read.
    """
    if not limit.count or not preset.chance_test:
        return preset, []
    detectors = list(dict.fromkeys(c.detector for c in combinations if c.guided or not c.of_pairs))
    image = survey_image(images)
    return reach_keypoints(
        methods, preset, image, detectors, limit.count, seed=seed, progress=progress
    )


def reach_keypoints(
    methods: Methods,
    preset: Preset,
    image: Image,
    detectors: Sequence[str],
    count: int,
    *,
    seed: int = 0,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> tuple[Preset, list[Footing]]:
    """Lower the thresholds of detectors until they find enough keypoints in an image.

    The same thresholds then hold for all images of a dataset.

    Parameters
    ----------
    methods : Methods
        With the parameters of `preset`.
    preset : Preset
    image : Image
        See `survey_image`.
    detectors : sequence of str
        Those that are to be used.
    count : int
        Keypoints in an image, 1 or more.
    seed : int
    progress : callable
        Called with how many detectors of how many are done.

    Returns
    -------
    Preset
        With the thresholds, under a name of its own.
    list of Footing
        One for each detector.

    Raises
    ------
    SelectionError
        If `count` is not positive.
    ImageError
        If the image cannot be read.
    """
    if count < 1:
        raise SelectionError(f"max_keypoints is {count}; give 1 or more to reach a number")
    decoded = Image(image.name, DecodedSource(image.read()))
    footings, changed = [], {}
    for done, name in enumerate(detectors, start=1):
        footing = _footing(methods, decoded, name, count, seed)
        footings.append(footing)
        if footing.steps and footing.parameter is not None and footing.value is not None:
            changed[name] = {**preset.detectors.get(name, {}), footing.parameter: footing.value}
        progress(done, len(detectors))
    named = replace(
        preset,
        name=f"{preset.name}-{count}",
        title=f"{preset.title}; thresholds lowered towards {count} keypoints",
        detectors={**preset.detectors, **changed},
    )
    return named, footings


def _footing(methods: Methods, image: Image, name: str, count: int, seed: int) -> Footing:
    row = methods.detectors[name]
    if row.unstable:
        # It can end the process, and has no threshold to lower.
        return Footing(name, None, None, 0, 0, reached=False)
    if row.threshold is None:
        found = _count(methods, row, image, seed)
        return Footing(name, None, None, 0, found, reached=found >= count)
    parameter = row.threshold[0]
    values = _values(row)
    found = 0
    for step, value in enumerate(values):
        changed = replace(row, parameters={**row.parameters, parameter: value})
        found = _count(methods, changed, image, seed)
        if found >= count or step == len(values) - 1:
            return Footing(name, parameter, value, step, found, reached=found >= count)
    raise AssertionError("there is always a first value")


def _values(row: DetectorRow) -> list[int | float]:
    """The threshold of a row, and lower ones down to the least that makes sense."""
    assert row.threshold is not None
    parameter, least = row.threshold
    first = row.parameters[parameter]
    assert isinstance(first, int | float)
    values: list[int | float] = [first]
    for power in range(1, MOST_STEPS + 1):
        lower = max(first * STEP**power, least)
        value: int | float = round(lower) if isinstance(first, int) else lower
        if value < values[-1]:
            values.append(value)
    return values


def _count(methods: Methods, row: DetectorRow, image: Image, seed: int) -> int:
    """Keypoints that a detector finds; 0 where it fails."""
    protocol = MeasurementProtocol(seed=seed, limit=KeypointLimit(0))
    changed: Mapping[str, DetectorRow] = {**methods.detectors, row.name: row}
    source = FeatureSource(replace(methods, detectors=changed), protocol, Clock(seed))
    found = source.detected(image, row.name)
    return len(found.keypoints) if isinstance(found, ImageFeatures) else 0
