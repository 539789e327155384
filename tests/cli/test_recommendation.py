from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from aerocues.cli.recommendation import answer
from aerocues.datasets.catalog import open_dataset
from aerocues.methods.presets import METHOD_PRESETS
from aerocues.phrases import likelihood
from aerocues.scoring.objectives import OBJECTIVES
from aerocues.tuning.race import RaceOutcome, Round
from aerocues.tuning.recommendation import Recommendation
from aerocues.tuning.representative import Seen

COLUMNS = (
    "precision", "precision_beyond_chance", "inliers", "excess_inliers", "detect_seconds",
    "describe_seconds", "match_seconds", "verify_seconds", "total_seconds",
)  # fmt: skip


def found(photos: Path, chances: Sequence[float], unseen: tuple[int, ...] = ()) -> Recommendation:
    """A recommendation out of so many combinations that succeeded, on three pairs."""
    names = [f"{letter}-X-HAM-BF" for letter in "ABC"[: len(chances)]]
    table: dict[str, Sequence[object]] = {"combination": names, "probability": chances}
    table |= {"score": np.linspace(0.9, 0.2, len(names)).tolist()}
    table |= {name: [3] * len(names) for name in ("pairs", "succeeded")}
    table |= {name: [0.5] * len(names) for name in COLUMNS}
    scores = np.linspace(1, 0, len(names))
    ended = RaceOutcome(
        scores,
        np.array(chances),
        np.ones((len(names), 3), np.bool_),
        "measured",
        [Round(61.0, 9, 1, names, chances[0])],
    )
    return Recommendation(
        open_dataset(str(photos)),
        Seen(tuple(range(3 - len(unseen))), (), unseen),
        3,
        OBJECTIVES["balanced"],
        ended,
        pl.DataFrame(table),
        7,
        len(names),
        photos,
        "a computer",
        METHOD_PRESETS[0],
    )


def test_the_only_one_that_succeeded_is_compared_with_nothing(photos: Path) -> None:
    words = " ".join(answer(found(photos, [1.0])).split())
    assert "median" not in words
    several = " ".join(answer(found(photos, [0.7, 0.3])).split())
    assert re.search(r"median of the 2 successful combinations .* 0\b", several)


@pytest.mark.parametrize(("width", "told"), [(0, False), (1000, True), (4000, False)])
def test_what_larger_images_may_change_is_told_where_it_applies(
    width: int, told: bool, photos: Path
) -> None:
    words = " ".join(answer(found(photos, [1.0]), width).split())
    assert ("measured on images of 1,000 px" in words) is told


def test_a_probability_is_of_these_pairs_and_never_certain(photos: Path) -> None:
    words = " ".join(answer(found(photos, [1.0, 0.0])).split())
    assert re.search(
        r"best of 7 .*>99%.* 6 measurements of 2 combinations on 3 pairs in 1 min 01 s", words
    )
    assert "100%" not in words


def test_pairs_that_there_was_no_time_for_are_told(photos: Path) -> None:
    words = " ".join(answer(found(photos, [0.6, 0.4], unseen=(2,))).split())
    assert re.search(r"\b2 pairs\b.*\b3\b.*--budget", words)
    assert "more images" not in words


@pytest.mark.parametrize(
    ("probability", "words"),
    [(0.0, "<1%"), (0.004, "<1%"), (0.01, "1%"), (0.61, "61%"), (0.996, ">99%"), (1.0, ">99%")],
)
def test_what_is_drawn_is_never_certain(probability: float, words: str) -> None:
    assert likelihood(probability) == words
