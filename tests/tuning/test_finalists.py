from __future__ import annotations

import polars as pl

from aerocues.tuning.finalists import finalists
from tests.scoring.measurements import rows
from tests.scoring.test_links import measured

GFTT, GFTT_FLANN = "GFTT-DAISY-L2-BF", "GFTT-DAISY-L2-FLANN"
STAR, ORB, SIFT, AKAZE, GFTT_SIFT = (
    "STAR-DAISY-L2-BF",
    "ORB-BEBLID-HAM-BF",
    "SIFT-SIFT-L2-BF",
    "AKAZE-SIFT-L2-BF",
    "GFTT-SIFT-L2-BF",
)
RANKED = [GFTT, GFTT_FLANN, STAR, GFTT_SIFT, ORB, AKAZE, SIFT]


def turned(right: dict[str, int]) -> pl.DataFrame:
    return rows(*(measured(name, pair, count) for name, count in right.items() for pair in (1, 3)))


def test_leaders_and_the_best_on_turned_pairs() -> None:
    found = finalists(RANKED, turned({GFTT: 3, STAR: 2, ORB: 50, SIFT: 90, AKAZE: 61}))
    assert [str(each) for each in found] == [GFTT, STAR, GFTT_SIFT, SIFT, AKAZE]


def test_what_failed_on_turned_pairs_is_not_taken_for_good() -> None:
    failed = rows(*(measured(SIFT, pair, 90, status="chance") for pair in (1, 3)))
    assert SIFT not in map(str, finalists(RANKED[:4], failed))
    once = rows(measured(SIFT, 1, 90))
    assert [str(each) for each in finalists(RANKED, once)][:3] == [GFTT, STAR, GFTT_SIFT]


def test_three_detectors_at_least() -> None:
    ranked = [GFTT, GFTT_SIFT, "GFTT-BRISK-HAM-BF", STAR, ORB, AKAZE]
    found = finalists(ranked, turned({GFTT: 1}).clear())
    assert [str(each) for each in found] == [*ranked[:3], STAR, ORB]
    plain = turned({GFTT: 1}).drop("reference_turn")
    assert [str(each) for each in finalists(ranked, plain)] == [*ranked[:3], STAR, ORB]
