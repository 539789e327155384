"""The preset of the thesis against its published figures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aerocues.scoring import SCORE_PRESETS, DecisionTable, Scores, criteria_named, score
from aerocues.scoring.sensitivity import Variants, by_aggregation, by_alpha
from tests.scoring.conftest import PublishedTable

THESIS = SCORE_PRESETS["thesis"]

SYNTHETIC = {
    "orb-orb-ham-bf": 0.8821,
    "orb-orb-ham-flann": 0.8789,
    "orb-teblid-ham-bf": 0.8445,
    "orb-boost-ham-bf": 0.8412,
    "star-brisk-ham-bf": 0.8383,
}
OXFORD = {
    "orb-beblid-ham-bf": 0.6219,
    "orb-teblid-ham-bf": 0.6152,
    "akaze-sift-l2-bf": 0.6078,
    "orb-teblid-ham-flann": 0.6058,
    "orb-beblid-ham-flann": 0.6027,
}
DRONE = {
    "orb-beblid-ham-bf": 0.8489,
    "orb-daisy-l2-bf": 0.8286,
    "orb-teblid-ham-bf": 0.8247,
    "orb-beblid-ham-flann": 0.8209,
    "gftt-daisy-l2-bf": 0.8155,
}


def with_reconstruction(table: DecisionTable, file: Path) -> DecisionTable:
    """The table with three criteria more, which have one value an alternative.

    Alternatives without a reconstruction lack them, but count for the bounds of the others.
    """
    import polars as pl

    frame = pl.read_csv(file)
    rows = {
        "-".join(row[:4]): row[4:]
        for row in frame.select(
            "detector",
            "descriptor",
            "norm",
            "matcher",
            "reprojection_error_px",
            "points_3d",
            "reconstruction_seconds",
        ).iter_rows()
    }
    figures = np.array([rows.get(name, (np.nan,) * 3) for name in table.alternatives])
    repeated = np.repeat(figures[:, None, :], len(table.repeats), axis=1)
    return replace(
        table,
        criteria=(*table.criteria, *criteria_named(THESIS.reconstruction_criteria)),
        values=np.concatenate([table.values, repeated], axis=2),
        failed=np.concatenate([table.failed, np.zeros(repeated.shape, dtype=bool)], axis=2),
    )


@pytest.fixture(scope="module")
def drone(published: PublishedTable, shared_data: Path) -> Scores:
    file = shared_data / "published" / "reconstruction.csv"
    return score(with_reconstruction(published("drone"), file), THESIS.settings)


def assert_top(scores: Scores, expected: dict[str, float], within: float = 0.005) -> None:
    top = scores.order[: len(expected)]
    assert [scores.table.alternatives[position] for position in top] == list(expected)
    np.testing.assert_allclose(scores.scores[top], list(expected.values()), rtol=0, atol=within)


@pytest.mark.parametrize(("dataset", "expected"), [("synthetic", SYNTHETIC), ("oxford", OXFORD)])
def test_top_five_by_pairs(
    published: PublishedTable, dataset: str, expected: dict[str, float]
) -> None:
    assert_top(score(published(dataset), THESIS.settings), expected)


def test_top_five_with_reconstruction(drone: Scores) -> None:
    assert len(drone.table.criteria) == 11
    assert_top(drone, DRONE)


PUBLISHED = SCORE_PRESETS["published"]
AIRSIM = {
    "orb-beblid-ham-bf": 0.7891,
    "orb-teblid-ham-bf": 0.7782,
    "orb-beblid-ham-flann": 0.7650,
    "orb-teblid-ham-flann": 0.7635,
    "kaze-sift-l2-bf": 0.7614,
}
UAV = {
    "gftt-daisy-l2-bf": 0.7299,
    "agast-sift-l2-bf": 0.7255,
    "akaze-daisy-l2-bf": 0.7189,
    "fast-sift-l2-bf": 0.7161,
    "agast-daisy-l2-bf": 0.7124,
}


@pytest.mark.parametrize(
    ("dataset", "expected"),
    [("synthetic", SYNTHETIC), ("oxford", OXFORD), ("airsim", AIRSIM), ("uav", UAV)],
)
def test_the_published_bounds_give_the_published_figures(
    published: PublishedTable, dataset: str, expected: dict[str, float]
) -> None:
    scores = score(published(dataset), PUBLISHED.settings)
    assert_top(scores, expected, within=0.00015)


def test_the_published_bounds_with_reconstruction(drone: Scores) -> None:
    assert_top(score(drone.table, PUBLISHED.settings), DRONE, within=0.0006)


def test_what_was_not_reconstructed_has_no_score(drone: Scores) -> None:
    lacking = np.isnan(drone.table.values[:, :, -3:]).all(axis=(1, 2))
    assert lacking.any()
    assert np.isnan(drone.scores[lacking]).all()
    assert len(drone.order) == 422


def correlation(variants: Variants, first: str, second: str) -> float:
    names = variants.names
    return float(variants.correlation[names.index(first), names.index(second)])


def test_sensitivity_to_alpha(drone: Scores) -> None:
    variants = by_alpha(drone)
    assert variants.names == ("0.1", "0.25", "0.5", "0.75")
    found = [correlation(variants, "0.5", other) for other in ("0.1", "0.25", "0.75")]
    assert found == pytest.approx([0.984, 0.995, 0.997], abs=0.002)


def test_sensitivity_to_aggregation(drone: Scores) -> None:
    variants = by_aggregation(drone)
    found = [
        correlation(variants, "arithmetic", other) for other in ("geometric", "harmonic", "trimmed")
    ]
    assert found == pytest.approx([0.9999, 0.9997, 0.9992], abs=0.002)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("failures", ["omit", "worst"])
@pytest.mark.parametrize(
    ("dataset", "platform"),
    [
        ("airsim", "desktop"),
        ("uav", "desktop"),
        ("synthetic", "mobile"),
        ("oxford", "mobile"),
        ("synthetic", "mobile2"),
        ("oxford", "mobile2"),
    ],
)
def test_other_data_sets_are_scored(
    published: PublishedTable, dataset: str, platform: str, failures: str
) -> None:
    table = published(dataset, platform)
    scores = score(table, replace(THESIS.settings, failures=failures))  # type: ignore[arg-type]
    known = scores.scores[~np.isnan(scores.scores)]
    assert len(known) > 450
    assert known.min() >= 0
    assert known.max() <= 1
    assert scores.weights.sum() == pytest.approx(1)
    if failures == "worst":
        assert len(known) == len(table.alternatives)
