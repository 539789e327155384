"""Links by class of pairs: what they do to scores, and how they come out of measured rows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import polars as pl
import pytest

from aerocues.errors import ScoreError
from aerocues.scoring.bootstrap import bootstrap
from aerocues.scoring.combinations import decision_table, suitable_preset
from aerocues.scoring.criteria import criteria_named
from aerocues.scoring.cues import score
from aerocues.scoring.finished import scores_of_finished
from aerocues.scoring.links import Links
from aerocues.scoring.measured import table_of as measured_table
from aerocues.scoring.objectives import OBJECTIVES
from aerocues.scoring.per_repeat import scores_of_repeats
from aerocues.scoring.settings import ScoreSettings
from tests.scoring.measurements import Stored, row, rows
from tests.scoring.tables import random_table, table_of

NAN = float("nan")


def test_the_factor_is_the_product_over_classes_of_the_mean_link() -> None:
    links = Links(
        np.array([[1.0, 0.5, 0.0, 0.0], [1.0, 1.0, 1.0, 0.5], [1.0, NAN, 0.5, NAN]]),
        np.array([0, 0, 1, 1]),
    )
    # By hand: (.05 + .75) / 1.05 x (.05 + 0) / 1.05; (.05 + 1) x (.05 + .75); (1.05) x (.55).
    expected = np.array([0.80 * 0.05, 1.05 * 0.80, 1.05 * 0.55]) / 1.05**2
    np.testing.assert_allclose(links.factor(np.ones((1, 4)))[0], expected)
    # A resample without a class tells nothing of it.
    np.testing.assert_allclose(
        links.factor(np.array([[2.0, 0, 0, 0]]))[0], np.array([1.0, 1.0, 1.0])
    )
    np.testing.assert_allclose(links.factor(np.array([[0.0, 3, 1, 0]]))[0][2], 0.55 / 1.05)


def test_scores_are_multiplied_by_links() -> None:
    table = random_table(3, repeats=4)
    share = np.random.default_rng(1).uniform(size=(8, 4))
    links = Links(share, np.array([0, 1, 0, 1]))
    linked = replace(table, links=links)
    plain, multiplied = score(table), score(linked)
    factor = links.factor(np.ones((1, 4)))[0]
    np.testing.assert_allclose(multiplied.scores, plain.scores * factor)
    np.testing.assert_allclose(multiplied.weights, plain.weights)
    kept = score(linked.with_alternatives([1, 2, 5]))
    again = score(table.with_alternatives([1, 2, 5]))
    np.testing.assert_allclose(kept.scores, again.scores * factor[[1, 2, 5]])
    resampled = bootstrap(multiplied, 50, seed=2)
    assert (resampled.scores <= bootstrap(plain, 50, seed=2).scores + 1e-12).all()
    single = scores_of_repeats(multiplied)
    np.testing.assert_allclose(single, scores_of_repeats(plain) * (0.05 + share) / 1.05)


def test_links_fit_the_table() -> None:
    with pytest.raises(ScoreError):
        Links(np.ones((2, 3)), np.zeros(2, np.int64))
    with pytest.raises(ScoreError):
        replace(random_table(1), links=Links(np.ones((8, 5)), np.zeros(5, np.int64)))


def test_ratios_stay_under_bounds_from_zero() -> None:
    table = table_of([[[0.2], [0.4]], [[0.5], [0.7]], [[0.1], [NAN]]])
    found = score(table, ScoreSettings(alpha=1.0, bounds="zero"))
    np.testing.assert_allclose(found.scores, [0.3 / 0.7, 0.6 / 0.7, 0.05 / 0.7])


def measured(combination: str, pair: int, right: int, **values: object) -> dict[str, object]:
    """A row with figures of a reference."""
    figures = {
        "reference": "flow",
        "reference_agreement": 0.9,
        "reference_turn": 180.0 if pair % 2 else 2.0,
        "ref_matches@3": float(right),
        "ref_matches@1": right / 2,
        "ref_matching_score@3": right / 400,
        "ref_precision@3": right / 100,
        "ref_repeatability": 0.5,
        "coverage": right / 200,
        "seconds_per_1k_ref_matches": 1000 / max(right, 1),
    }
    return row(combination, pair, **{**figures, **values})


UPRIGHT, TURNING = "GFTT-DAISY-L2-BF", "SIFT-SIFT-L2-BF"


def flight() -> pl.DataFrame:
    """Upright pairs that both match, turned ones that one matches; a pair without a reference."""
    nothing = {"reference": "the matches disagree", "reference_turn": None, "coverage": None}
    return rows(
        *(measured(UPRIGHT, pair, 0 if pair % 2 else 190) for pair in range(4)),
        *(measured(TURNING, pair, 70) for pair in range(4)),
        measured(UPRIGHT, 4, 0, **nothing),
        measured(TURNING, 4, 0, **nothing),
    )


def test_what_links_no_turned_pair_does_not_win() -> None:
    assert suitable_preset(flight()).name == "default"
    for preset in ("default", "models"):
        found = measured_table(Stored(flight()), preset)
        assert found.table.repeats == ("0", "1", "2", "3")
        scores = score(found.table, found.preset.settings)
        assert scores.table.alternatives[scores.best] == TURNING
    models = measured_table(Stored(flight()), "models").table
    scores = score(models, ScoreSettings(alpha=1.0, bounds="zero"))
    # By hand: classes turned and other; of 190 right matches, the most, the quality is 1.
    expected = [0.05 / 1.05 * (1 + 0) / 2, np.sqrt(70 / 190)]
    np.testing.assert_allclose(scores.scores, expected, rtol=1e-12)
    upright = measured_table(Stored(flight()), criteria=["expected_quality"]).table
    assert upright.links is None


def test_a_failed_pair_links_nothing_and_an_unmeasured_one_says_nothing() -> None:
    table = rows(
        measured(TURNING, 0, 70, status="chance"),
        measured(TURNING, 1, 70),
        measured(UPRIGHT, 1, 30),
    )
    found = decision_table(table, criteria_named(["coverage"]), links=True)
    assert found.links is not None
    np.testing.assert_allclose(found.links.share, [[NAN, 0.5], [0.0, 1.0]])
    assert found.links.classes.tolist() == [0, 1]


def test_failed_pairs_are_no_links_in_finished_results() -> None:
    table = rows(
        *(measured(UPRIGHT, n, 190, status="chance" if n % 2 else "ok") for n in range(4)),
        *(measured(TURNING, n, 70) for n in range(4)),
    )
    found = scores_of_finished(table, OBJECTIVES["reconstruction"], resamples=2, seed=0)
    scores = dict(zip(found.alternatives, found.scores, strict=True))
    # By hand: the worst quality, of 70 matches, where it failed, and no link to any turned pair.
    assert scores[UPRIGHT] == pytest.approx((1 + np.sqrt(70 / 190)) / 2 * 0.05 / 1.05)
    assert scores[TURNING] == pytest.approx(np.sqrt(70 / 190))


def test_without_references_scores_are_by_inliers() -> None:
    plain = rows(row(TURNING, 0), row(UPRIGHT, 0))
    assert suitable_preset(plain).name == "inliers"
    with pytest.raises(ScoreError, match="reference"):
        measured_table(Stored(plain), "default")
