"""Pairs that stand for a flight: of each class that occurs, the weak links, every image held."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from aerocues.pipeline.survey import Survey, SurveyedPair

Place = Literal["turned", "along", "across"]
"""Turned against each other; else next to each other in the order of the flight, or not."""
PLACES: tuple[Place, ...] = ("turned", "along", "across")
# A mean over all pairs hides the turned ones, which decide whether strips join: six pairs of which
# a third to a half are turned tell the best model as well as all (ten flights).
TURNED_SHARE = 0.4
WEAKEST_SHARE = 0.25


def place_of(pair: SurveyedPair) -> Place:
    """Where the two images of a pair lie in a flight."""
    if pair.kind == "turned":
        return "turned"
    return "along" if pair.image_2 - pair.image_1 == 1 else "across"


@dataclass(frozen=True)
class Representatives:
    """Pairs that stand for all pairs of a survey that show the same things.

    Parameters
    ----------
    pairs : tuple of SurveyedPair
        In the order of the flight.
    held : int
        Images that some pair of them holds.
    components : int
        Groups of images between which nothing links; images without any link are not counted.
    """

    pairs: tuple[SurveyedPair, ...]
    held: int
    components: int


def enough_pairs(images: int, most: int) -> int:
    """So many pairs, but no fewer than can hold all images."""
    return max(most, math.ceil(images / 2))


def representatives(survey: Survey, most: int, seed: int = 0) -> Representatives:
    """Choose pairs that stand for a flight.

    First the weakest of the links that hold the flight together (of its strongest spanning tree),
    then pairs of images that none holds yet, then others, of each class its share; among equal
    ones the seed decides.

    Parameters
    ----------
    survey : Survey
    most : int
        Pairs, at most.
    seed : int
    """
    tree, components = _spanning_tree(survey)
    if len(survey.pairs) <= most:
        chosen = list(survey.pairs)
    else:
        order = np.random.default_rng(seed).permutation(len(survey.pairs))
        choice = _Choice([survey.pairs[place] for place in order], most)
        weakest = sorted(tree, key=lambda pair: pair.inliers)
        choice.take(weakest[: max(int(WEAKEST_SHARE * most), 1)])
        choice.fill()
        chosen = choice.chosen
    chosen.sort(key=lambda pair: (pair.image_1, pair.image_2))
    return Representatives(tuple(chosen), len(_images(chosen)), components)


def _images(pairs: Iterable[SurveyedPair]) -> set[int]:
    return {image for pair in pairs for image in (pair.image_1, pair.image_2)}


class _Choice:
    """Pairs that were chosen, and what is still to be had."""

    def __init__(self, pairs: list[SurveyedPair], most: int) -> None:
        self._left = pairs
        self._most = most
        self._shares = _shares(pairs)
        self.chosen: list[SurveyedPair] = []

    def take(self, pairs: Iterable[SurveyedPair]) -> None:
        for pair in pairs:
            self.chosen.append(pair)
            self._left.remove(pair)

    def fill(self) -> None:
        """Take what holds most new images, of the class that lacks most, until there are enough."""
        while len(self.chosen) < self._most and self._left:
            held = _images(self.chosen)
            lacking = {place: self._lacking(place) for place in PLACES}
            worth = [
                ((pair.image_1 not in held) + (pair.image_2 not in held), lacking[place_of(pair)])
                for pair in self._left
            ]
            self.take([self._left[worth.index(max(worth))]])

    def _lacking(self, place: Place) -> float:
        own = sum(place_of(pair) == place for pair in self.chosen)
        return self._shares[place] * self._most - own


def _shares(pairs: list[SurveyedPair]) -> dict[Place, float]:
    """What part of the pairs each class gets: the turned ones theirs, the rest by number."""
    counts = {place: sum(place_of(pair) == place for pair in pairs) for place in PLACES}
    upright = counts["along"] + counts["across"]
    turned = TURNED_SHARE if counts["turned"] and upright else float(bool(counts["turned"]))
    rest = (1.0 - turned) / max(upright, 1)
    return {
        "turned": turned,
        "along": rest * counts["along"],
        "across": rest * counts["across"],
    }


def _spanning_tree(survey: Survey) -> tuple[list[SurveyedPair], int]:
    """The strongest links that hold images together, and the number of groups they hold."""
    group = list(range(len(survey.images)))

    def root(image: int) -> int:
        while group[image] != image:
            group[image] = group[group[image]]
            image = group[image]
        return image

    tree = []
    for pair in sorted(survey.pairs, key=lambda pair: -pair.inliers):
        first, second = root(pair.image_1), root(pair.image_2)
        if first != second:
            group[first] = second
            tree.append(pair)
    linked = _images(survey.pairs)
    return tree, len({root(image) for image in linked})
