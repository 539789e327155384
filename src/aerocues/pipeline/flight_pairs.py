"""The pairs that stand for a flight, chosen by a survey of its images."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.catalog import takes_pairs
from aerocues.datasets.dataset import Dataset, Pair
from aerocues.pipeline.representative import (
    Representatives,
    enough_pairs,
    place_of,
    representatives,
)
from aerocues.pipeline.survey import Survey, Surveyor
from aerocues.pipeline.survey_folder import read_survey, survey_key, write_survey
from aerocues.results.hashing import content_hash

FEWEST_IMAGES = 3
"""Two images are one pair: there is nothing to choose."""


@dataclass(frozen=True, eq=False)
class SurveyedFlight:
    """A flight with pairs that stand for all of its pairs.

    Parameters
    ----------
    dataset : Dataset
        With the representative pairs.
    survey : Survey
    chosen : Representatives
    """

    dataset: Dataset
    survey: Survey
    chosen: Representatives

    def classes_of(self, pairs: Sequence[int]) -> NDArray[np.int64]:
        """(P,) 1 where the two images of a representative pair are turned, else 0."""
        turned = [self.chosen.pairs[pair].kind == "turned" for pair in pairs]
        return np.array(turned, np.int64)

    def notes(self) -> list[str]:
        """What the survey saw, and what it warns of, a sentence each."""
        survey, chosen = self.survey, self.chosen
        turned = sum(pair.kind == "turned" for pair in survey.pairs)
        used = sum(place_of(pair) == "turned" for pair in chosen.pairs)
        notes = [
            f"{len(survey.pairs)} of {len(survey.candidates)} pairs that may overlap do so, "
            f"{turned} of them turned against each other; {len(chosen.pairs)} stand for them, "
            f"{used} of them turned"
        ]
        if chosen.components > 1:
            notes.append(
                f"the images fall into {chosen.components} groups that no pair joins: no "
                "combination may make one model of them"
            )
        unreadable = [name for name, _ in survey.unreadable]
        partners = dict(zip(survey.images, survey.partners().tolist(), strict=True))
        alone = [name for name in survey.images if not partners[name] and name not in unreadable]
        for what, names in (
            ("overlap with no other", alone),
            ("cannot be read", unreadable),
        ):
            if names:
                shown = ", ".join(names[:3]) + (", ..." if len(names) > 3 else "")
                notes.append(f"{len(names)} of {len(survey.images)} images {what}: {shown}")
        if unreadable:
            notes.append(f"their pairs are left out: {survey.unreadable[0][1]}")
        return notes


def leaves_pairs_open(dataset: Dataset) -> bool:
    """Whether nobody chose the pairs of a flight: they are then the consecutive ones."""
    source = dataset.source
    return (
        source is not None
        and source.pairs is None
        and source.max_pairs is None
        and dataset.geometry == "epipolar"
        and len(dataset.images) >= FEWEST_IMAGES
        and takes_pairs(source.spec)
        and len({pair.sequence for pair in dataset.pairs}) == 1
    )


def survey_flight(
    dataset: Dataset,
    most: int,
    seed: int,
    progress: Callable[[int, int], None],
    folder: Path | None = None,
    *,
    keep: bool = True,
    survey: Survey | None = None,
) -> SurveyedFlight | None:
    """A flight with representative pairs in place of the consecutive ones.

    Consecutive pairs show one strip. A drone turns round and flies the next one back, so that
    neighbours across strips are turned by 180 degrees.

    Parameters
    ----------
    dataset : Dataset
    most : int
        Pairs; more only where fewer cannot hold all images.
    seed : int
    progress : callable
        Called with how many images and pairs of how many were looked at.
    folder : path, optional
        Where surveys are kept; one that is there is not made again.
    keep : bool
        Whether a new survey is written there.
    survey : Survey, optional
        The survey of these images where it was made already; how they are turned does not count.

    Returns
    -------
    SurveyedFlight or None
        None where somebody chose the pairs, or no two images overlap: measuring then says why.
    """
    if not leaves_pairs_open(dataset):
        return None
    survey = survey or surveyed(dataset, seed, progress, folder, keep=keep)
    chosen = representatives(survey, enough_pairs(len(dataset.images), most), seed)
    if not chosen.pairs:
        return None
    sequence = dataset.pairs[0].sequence
    pairs = [
        Pair(number, survey.images[pair.image_1], survey.images[pair.image_2], sequence)
        for number, pair in enumerate(chosen.pairs)
    ]
    others = tuple(each for each in dataset.settings if each[0] != "pairs")
    # Rows of other pairs, drawn from another survey, do not stand beside these in one folder.
    which = content_hash([(pair.image_1, pair.image_2) for pair in pairs])
    settings = (*others, ("pairs", f"representative:{len(pairs)}:{which}"))
    return SurveyedFlight(replace(dataset, pairs=pairs, settings=settings), survey, chosen)


def surveyed(
    dataset: Dataset,
    seed: int,
    progress: Callable[[int, int], None],
    folder: Path | None,
    *,
    keep: bool = True,
) -> Survey:
    """The survey of all images of a dataset; parameters as in `survey_flight`."""
    if folder is None:
        return Surveyor(dataset.images, seed).survey(progress)
    key = survey_key(dataset.images, seed)
    found = read_survey(folder, key)
    if found is None:
        found = Surveyor(dataset.images, seed).survey(progress)
        if keep:
            write_survey(folder, key, found)
    return found
