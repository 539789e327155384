from __future__ import annotations

from pathlib import Path

import pytest

from aerocues.datasets.dataset import Dataset, Image, Pair
from aerocues.datasets.decoding import FileSource
from aerocues.errors import DatasetError
from aerocues.tuning.splits import given_split, split_pairs


def dataset(name: str, *sequences: int) -> Dataset:
    """A data set with sequences of so many consecutive pairs."""
    pairs = [
        Pair(0, f"{scene}/{number}", f"{scene}/{number + 1}", f"{scene}")
        for scene, count in enumerate(sequences)
        for number in range(count)
    ]
    numbered = [
        Pair(index, each.image_1, each.image_2, each.sequence) for index, each in enumerate(pairs)
    ]
    names = {name for pair in numbered for name in (pair.image_1, pair.image_2)}
    images = [Image(each, FileSource(Path(each))) for each in sorted(names)]
    return Dataset(name, images, numbered, "epipolar")


def test_sequences_go_to_one_side_as_wholes() -> None:
    datasets = [dataset("a", 5, 5, 5, 5), dataset("b", 3, 3)]
    splits = split_pairs(datasets, 0, 100)
    for each, split in zip(datasets, splits, strict=True):
        sides = [
            {each.pair(number).sequence for number in side}
            for side in (split.training, split.validation)
        ]
        assert not sides[0] & sides[1]
        assert len(split.training) + len(split.validation) == len(each.pairs)
    assert split_pairs(datasets, 0, 100) == splits
    assert any(split_pairs(datasets, seed, 100) != splits for seed in range(1, 6))


def test_a_single_flight_is_halved_without_a_shared_image() -> None:
    flight = dataset("flight", 20)
    [split] = split_pairs([flight], 0, 100)
    assert split.by == "half of the flight"
    images = [
        {name for number in side for name in (flight.pair(number).image_1,
                                              flight.pair(number).image_2)}
        for side in (split.training, split.validation)
    ]  # fmt: skip
    assert not images[0] & images[1]
    assert max(split.training) < min(split.validation)


def test_each_data_set_gives_as_many_pairs() -> None:
    splits = given_split([dataset("a", 40), dataset("b", 10)], [dataset("c", 30)], 16)
    assert [len(split.training) for split in splits] == [8, 8, 0]
    assert [len(split.validation) for split in splits] == [0, 0, 16]


def test_too_few_pairs_are_told() -> None:
    with pytest.raises(DatasetError, match="validation"):
        split_pairs([dataset("a", 4)], 0, 10)
    with pytest.raises(DatasetError, match="training"):
        given_split([dataset("a", 1)], [dataset("b", 9)], 10)
