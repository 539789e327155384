"""Pairs to choose by and pairs to judge by, never of the same scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from aerocues.datasets.dataset import Dataset, Pair
from aerocues.errors import DatasetError
from aerocues.tuning.representative import spread_pairs

FEWEST = 2


@dataclass(frozen=True)
class Split:
    """Numbers of pairs of one data set, and how they were divided."""

    training: tuple[int, ...]
    validation: tuple[int, ...]
    by: str


def split_pairs(datasets: Sequence[Dataset], seed: int, most: int) -> list[Split]:
    """Divide the pairs of data sets in two halves.

    Sequences go to one side as wholes. Where there is one sequence in all, a flight, its first
    half is for training and its second for validation, without pairs that share an image.

    Parameters
    ----------
    datasets : sequence of Dataset
    seed : int
        Decides which sequences are for training.
    most : int
        Pairs of each side, about; each data set gives as many, spread evenly over it.

    Raises
    ------
    DatasetError
        If one side has fewer than two pairs.
    """
    scenes = [
        (number, sequence)
        for number, dataset in enumerate(datasets)
        for sequence in dict.fromkeys(pair.sequence for pair in dataset.pairs)
    ]
    if len(scenes) == 1:
        splits = [_halves(datasets[0].pairs, most)]
    else:
        order = np.random.default_rng(seed).permutation(len(scenes))
        training = {scenes[place] for place in order[: (len(scenes) + 1) // 2]}
        splits = [
            _by_sequence(number, dataset, training, _share(most, len(datasets)))
            for number, dataset in enumerate(datasets)
        ]
    _check(splits)
    return splits


def given_split(
    training: Sequence[Dataset], validation: Sequence[Dataset], most: int
) -> list[Split]:
    """Pairs to choose by from some data sets, and pairs to judge by from others.

    Raises
    ------
    DatasetError
        If one side has fewer than two pairs.
    """
    nothing: tuple[int, ...] = ()
    splits = [
        Split(_numbers(dataset.pairs, _share(most, len(training))), nothing, "data set")
        for dataset in training
    ]
    splits += [
        Split(nothing, _numbers(dataset.pairs, _share(most, len(validation))), "data set")
        for dataset in validation
    ]
    _check(splits)
    return splits


def _check(splits: Sequence[Split]) -> None:
    for side in ("training", "validation"):
        if sum(len(getattr(split, side)) for split in splits) < FEWEST:
            raise DatasetError(
                f"fewer than {FEWEST} pairs are left for {side}; give more images or data sets"
            )


def _share(most: int, datasets: int) -> int:
    return max(round(most / datasets), 1)


def _numbers(pairs: Sequence[Pair], most: int) -> tuple[int, ...]:
    return tuple(pair.index for pair in spread_pairs(pairs, most))


def _by_sequence(number: int, dataset: Dataset, training: set[tuple[int, str]], most: int) -> Split:
    sides: tuple[list[Pair], list[Pair]] = ([], [])
    for pair in dataset.pairs:
        sides[(number, pair.sequence) not in training].append(pair)
    training_pairs, validation_pairs = (_numbers(side, most) for side in sides)
    return Split(training_pairs, validation_pairs, "sequence")


def _halves(pairs: Sequence[Pair], most: int) -> Split:
    middle = len(pairs) // 2
    first, second = list(pairs[:middle]), list(pairs[middle:])
    seen = {name for pair in first for name in (pair.image_1, pair.image_2)}
    apart = [pair for pair in second if not {pair.image_1, pair.image_2} & seen]
    return Split(_numbers(first, most), _numbers(apart, most), "half of the flight")
