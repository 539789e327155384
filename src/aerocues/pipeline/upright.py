"""A common heading: by how many quarters images are turned before features are found in them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from aerocues.arguments import check_whole
from aerocues.datasets.catalog import DatasetLike, as_dataset
from aerocues.datasets.dataset import Dataset, with_turns
from aerocues.pipeline.flight_pairs import surveyed
from aerocues.pipeline.survey import Survey

AGREE = 20.0
"""Degrees by which the yaw of metadata may differ from the rotation of the pixels."""
TURNED = 60.0
"""Degrees from which on images are turned against each other."""
NO_YAWS: Mapping[str, float] = MappingProxyType({})


def upright(
    dataset: DatasetLike,
    *,
    seed: int = 0,
    folder: str | Path | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Dataset:
    """Images that are turned to a common heading while features are found in them.

    Many learned methods, and some classic ones, match nothing in images that are turned against
    each other, as those of neighbouring strips of a flight are. A quick match finds how images are
    turned; each is then turned by a multiple of 90 degrees, which is exact, and positions are
    turned back. Up to 45 degrees remain. Images that no pair joins keep their heading, unless the
    yaw in their metadata tells it and agrees with the pixels of the others.

    Parameters
    ----------
    dataset : Dataset, str, path or sequence of paths
        See `open_dataset`.
    seed : int
    folder : str or path, optional
        Where surveys are kept; one that is there is not made again.
    progress : callable
        Called with how many images and pairs of how many were looked at.

    Returns
    -------
    Dataset
        For `run`, `recommend` and `reconstruct`; rows tell how their images were turned.

    Raises
    ------
    ArgumentError
        If `seed` is not a whole number from 0 on.
    AerocuesError
        If the images cannot be opened.
    """
    check_whole("seed", seed, 0)
    return turned_upright(as_dataset(dataset), seed, progress, folder)


def turned_upright(
    dataset: Dataset,
    seed: int,
    progress: Callable[[int, int], None] = lambda done, total: None,
    folder: str | Path | None = None,
) -> Dataset:
    """As `upright`, of what is opened."""
    place = None if folder is None else Path(folder)
    return turned_as_surveyed(dataset, surveyed(dataset, seed, progress, place))


def turned_as_surveyed(dataset: Dataset, survey: Survey) -> Dataset:
    """Images that are turned to a common heading, which a survey of them shows."""
    yaws = {image.name: image.yaw for image in dataset.images if image.yaw is not None}
    turns = turns_to_common_heading(survey, yaws)
    count = sum(turn != 0 for turn in turns.values())
    told = f"{count} of {len(turns)} images are turned to a common heading"
    return replace(with_turns(dataset, turns), notes=(*dataset.notes, told))


def turns_to_common_heading(survey: Survey, yaws: Mapping[str, float] = NO_YAWS) -> dict[str, int]:
    """By how many degrees counterclockwise each image is turned: 0, 90, 180 or 270, by name.

    Most images of each group that pairs join stay as they are. Yaws of metadata (degrees, by name)
    join groups where they agree with the pixels.
    """
    headings, groups = _headings(survey)
    yaw = np.array([yaws.get(name, np.nan) for name in survey.images])
    headings, groups = _joined(headings, groups, yaw)
    turns = np.zeros(len(survey.images), np.int64)
    for group in np.unique(groups):
        own = groups == group
        turns[own] = _quarters(headings[own]) * 90
    return dict(zip(survey.images, turns.tolist(), strict=True))


def _headings(survey: Survey) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Clockwise rotation of each image against the first of its group, degrees, and its group.

    Rotations are added up along the surest pairs.
    """
    headings = np.zeros(len(survey.images))
    groups = np.arange(len(survey.images))
    for pair in sorted(survey.pairs, key=lambda pair: -pair.inliers):
        first, second = groups[[pair.image_1, pair.image_2]]
        if first == second:
            continue
        moved = groups == second
        headings[moved] += headings[pair.image_1] + pair.rotation - headings[pair.image_2]
        groups[moved] = first
    return headings, groups


def _joined(
    headings: NDArray[np.float64], groups: NDArray[np.int64], yaw: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Headings and groups as the yaws of metadata join them; as they are where these disagree.

    Somebody may have turned images after the flight, and gimbals that look straight down may tell
    anything: each group must agree, and one must show that its yaws follow a turn of the pixels.
    """
    joined, merged = headings.copy(), groups.copy()
    turned = False
    for group in np.unique(groups[np.isfinite(yaw)]):
        own = (groups == group) & np.isfinite(yaw)
        # A camera that turns clockwise turns the picture counterclockwise.
        apart = np.exp(1j * np.radians(headings[own] + yaw[own]))
        common = apart.mean()
        away = np.abs(np.degrees(np.angle(apart / common)))
        if not away.max() <= AGREE:
            return headings, groups
        turned |= _least_arc(headings[own]) >= TURNED
        joined[groups == group] -= np.degrees(np.angle(common))
        merged[groups == group] = -1
    return (joined, merged) if turned else (headings, groups)


def _least_arc(headings: NDArray[np.float64]) -> float:
    """Degrees of the least arc that holds all headings, whatever their order."""
    around = np.sort(headings % 360)
    return float(360 - np.diff(around, append=around[0] + 360).max())


def _quarters(headings: NDArray[np.float64]) -> NDArray[np.int64]:
    """Quarters, 0 to 3, by which images are turned back, so that most stay as they are."""
    # Where headings lie between the quarters, all of them do: what they have in common counts.
    common = np.angle(np.exp(4j * np.radians(headings)).sum()) / 4
    quarters = np.round((headings - np.degrees(common)) / 90).astype(np.int64) % 4
    most = int(np.bincount(quarters, minlength=4).argmax())
    return np.asarray((quarters - most) % 4, np.int64)
