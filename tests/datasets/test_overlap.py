from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aerocues.datasets.dataset import Image
from aerocues.datasets.decoding import FileSource
from aerocues.datasets.overlap import Overlapping
from aerocues.datasets.pairing import parse_pairs
from aerocues.errors import DatasetError
from tests.datasets.test_true_geometry import Depth, view_from


def images(*easts: float) -> list[Image]:
    """Pictures of level ground, each 20 m wide."""
    return [
        Image(str(number), FileSource(Path(f"{number}.png")), truth=view_from(east).view)
        for number, east in enumerate(easts)
    ]


def test_pairs_have_the_share_of_ground_that_was_asked_for() -> None:
    row = images(0, 4, 10, 50)  # neighbours share 80, 70 and 0 %; the outer two of three 50 %
    assert Overlapping(0.75).pairs(row) == [("0", "1")]
    assert Overlapping(0.4, 0.75).pairs(row) == [("0", "2"), ("1", "2")]
    assert Overlapping(0.1).pairs(row) == [("0", "1"), ("0", "2"), ("1", "2")]


def test_what_is_hidden_is_not_shared() -> None:
    first, second = images(0, 2)
    assert second.truth is not None
    roof = np.full((80, 100), 10.0, np.float32)
    roof[:, :50] = 5.0
    hidden = replace(second, truth=replace(second.truth, depth=Depth(roof)))
    assert Overlapping(0.85).pairs([first, second]) == [("0", "1")]
    with pytest.raises(DatasetError, match=r"0\.85 to 1\b"):
        Overlapping(0.85).pairs([first, hidden])


def test_views_of_the_sky_may_share_it() -> None:
    first, second = images(0, 400)
    sky = Depth(np.full((80, 100), np.inf, np.float32))
    above = [
        replace(each, truth=replace(each.truth, depth=sky)) if each.truth else each
        for each in (first, second)
    ]
    assert Overlapping(0.9).pairs(above) == [("0", "1")]


def test_overlap_needs_depth() -> None:
    row = [*images(0), replace(images(0, 1)[1], truth=None)]
    with pytest.raises(DatasetError, match=r"\b1 .*pairs=.consecutive"):
        Overlapping(0.5).pairs(row)


@pytest.mark.parametrize(
    ("text", "limits"), [("overlap:0.3-0.9", (0.3, 0.9)), ("overlap:.5", (0.5, 1.0))]
)
def test_its_text_form(text: str, limits: tuple[float, float]) -> None:
    assert parse_pairs(text) == Overlapping(*limits)


@pytest.mark.parametrize("text", ["overlap:0.9-0.3", "overlap:0", "overlap:30-90"])
def test_limits_that_make_no_sense(text: str) -> None:
    with pytest.raises(DatasetError, match=r"0\.3-0\.9"):
        parse_pairs(text)
