"""Training and validation pairs, never of the same scene."""

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
    """Training and validation pairs of one dataset, and how they were divided."""

    training: tuple[int, ...]
    validation: tuple[int, ...]
    by: str


def split_pairs(datasets: Sequence[Dataset], seed: int, most: int) -> list[Split]:
    """Divide the pairs of datasets into training and validation.

    A sequence is never divided, unless it is the only one, as in a flight: then its first half is
    for training and its second half for validation, without pairs that share an image.

    Parameters
    ----------
    datasets : sequence of Dataset
    seed : int
        Decides which sequences are for training.
    most : int
        Approximate number of pairs of each side; all datasets contribute equally, evenly spread.

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
    """Training pairs from some datasets, and validation pairs from others.

    Raises
    ------
    DatasetError
        If one side has fewer than two pairs.
    """
    nothing: tuple[int, ...] = ()
    splits = [
        Split(_numbers(dataset.pairs, _share(most, len(training))), nothing, "dataset")
        for dataset in training
    ]
    splits += [
        Split(nothing, _numbers(dataset.pairs, _share(most, len(validation))), "dataset")
        for dataset in validation
    ]
    _check(splits)
    return splits


def _check(splits: Sequence[Split]) -> None:
    for side in ("training", "validation"):
        if sum(len(getattr(split, side)) for split in splits) < FEWEST:
            raise DatasetError(
                f"fewer than {FEWEST} pairs are left for {side}; give more images or datasets"
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
