"""Relations of figures of pairs with outcomes of reconstructions, against scipy and by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import polars as pl
import pytest
from scipy.stats import pearsonr, spearmanr

import aerocues
from aerocues.errors import ScoreError
from aerocues.scoring.outcomes import OUTCOMES, relate_outcomes
from aerocues.scoring.pair_figures import LINK_QUALITY
from tests.scoring.measurements import METHODS, Stored, models, row, rows

NAMES = tuple(f"D{number}-E-L2-BF" for number in range(8))
# By combination: inliers of its two pairs.
INLIERS = ((90, 70), (60, 64), (50, 41), (30, 44), (22, 20), (13, 15), (12, 11), (9, 8))
MEASURED = rows(
    *(
        row(name, pair, inliers=inliers)
        for name, both in zip(NAMES, INLIERS, strict=True)
        for pair, inliers in enumerate(both)
    )
)
KINDS = {outcome.name: pl.Float64() for outcome in OUTCOMES}


def reconstructed(*figures: dict[str, Any]) -> pl.DataFrame:
    """Rows of the combinations in turn."""
    return pl.DataFrame(
        [
            {
                "dataset": "flight",
                **dict(zip(METHODS, name.split("-"), strict=True)),
                "status": "ok",
                "reference": None,
                **dict.fromkeys(KINDS),
                **figure,
            }
            for name, figure in zip(NAMES, figures, strict=False)
        ],
        schema_overrides={**KINDS, "reference": pl.String()},
    )


POINTS = (900, 950, 700, 400, 410, 100, 90, 110)
MODELS = reconstructed(*({"points_3d": points, "registered_images": 18} for points in POINTS))


def test_correlations_are_those_of_scipy() -> None:
    found = relate_outcomes(Stored(MEASURED, MODELS))
    means = np.mean(INLIERS, axis=1)
    at = (found.features.index("inliers"), found.outcomes.index("points_3d"))
    assert found.pearson[at] == pytest.approx(pearsonr(means, POINTS).statistic)
    assert found.spearman[at] == pytest.approx(spearmanr(means, POINTS).statistic)
    assert found.numbers[at] == 8
    np.testing.assert_allclose(found.feature_values[:, at[0]], means)
    np.testing.assert_allclose(found.outcome_values[:, at[1]], POINTS)


def test_by_hand() -> None:
    measured = rows(*(row(name, 0, inliers=10 * n) for n, name in enumerate(NAMES[:5], start=1)))
    counts = [{"points_3d": points} for points in (1, 2, 4, 3, 5)]
    found = relate_outcomes(Stored(measured, reconstructed(*counts)))
    at = (found.features.index("inliers"), found.outcomes.index("points_3d"))
    # Of ranks, 1 - 6 (0 + 0 + 1 + 1 + 0) / (5 (25 - 1)); here the values are their ranks.
    assert found.spearman[at] == pytest.approx(0.9)
    assert found.pearson[at] == pytest.approx(0.9)


def test_figures_of_a_model_are_of_successes_and_registered_images_of_all() -> None:
    figures: list[dict[str, Any]] = [
        {"points_3d": points, "registered_images": 18 - number}
        for number, points in enumerate(POINTS)
    ]
    figures[3] |= {"status": "incomplete", "registered_images": 5, "points_3d": 20}
    figures[4] |= {"status": "no_verified_pair", "registered_images": None, "points_3d": None}
    figures[5] |= {"status": "crashed", "registered_images": None, "points_3d": None}
    found = relate_outcomes(Stored(MEASURED, reconstructed(*figures)))
    by_name = dict(zip(found.outcomes, found.outcome_values.T, strict=True))
    np.testing.assert_array_equal(by_name["registered_images"], [18, 17, 16, 5, 0, np.nan, 12, 11])
    np.testing.assert_array_equal(by_name["points_3d"], [900, 950, 700, *3 * [np.nan], 90, 110])
    numbers = found.numbers[found.features.index("inliers")]
    assert dict(zip(found.outcomes, numbers, strict=True)) == {
        "registered_images": 7,
        "points_3d": 5,
    }
    figures[6]["status"] = "misplaced"
    few = relate_outcomes(Stored(MEASURED, reconstructed(*figures)))
    assert few.outcomes == ("registered_images",)


def test_the_reference_has_no_distance_to_itself() -> None:
    figures = [{"cloud_distance_rms": float(number), "reference": NAMES[0]} for number in range(8)]
    found = relate_outcomes(Stored(MEASURED, reconstructed(*figures)))
    assert found.outcomes == ("cloud_distance_rms",)
    np.testing.assert_array_equal(found.outcome_values[:, 0], [np.nan, 1, 2, 3, 4, 5, 6, 7])


def test_failed_pairs_count_for_the_success_rate_only() -> None:
    measured = rows(
        *MEASURED.filter(pl.col("pair") == 0).to_dicts(),
        *(row(name, 1, status="chance", inliers=999) for name in NAMES[:2]),
        *(row(name, 1, status="no_model", inliers=999) for name in NAMES[2:]),
    )
    stored = Stored(measured, MODELS)
    found = relate_outcomes(stored, "inliers")
    at = found.features.index("inliers")
    np.testing.assert_array_equal(found.feature_values[:, at], [each[0] for each in INLIERS])
    assert "success_rate" not in found.features  # it is one half for all
    by_thesis = relate_outcomes(stored, "thesis")
    rate = by_thesis.feature_values[:, by_thesis.features.index("success_rate")]
    np.testing.assert_array_equal(rate, [1, 1, *6 * [0.5]])


def test_links_times_coverage_by_hand() -> None:
    def seen(name: str, pair: int, right: int, coverage: float, **more: Any) -> dict[str, Any]:
        turn = 180.0 if pair == 2 else 0.0
        told = {"reference": "flow", "reference_turn": turn, "ref_matches@3": right}
        told |= {"ref_matches@1": right / 2}
        return row(name, pair, coverage=coverage, **told, **more)

    measured = rows(
        *(seen(name, 0, 120, 0.1 + n / 100) for n, name in enumerate(NAMES)),
        *(seen(name, 1, 30, 0.2) for name in NAMES),
        *(seen(name, 2, 60, 0.3) for name in NAMES[:5]),
        *(seen(name, 2, 15, 0.3, status="chance") for name in NAMES[5:]),
    )
    # Same heading: (1 + 1/2) / 2; turned: 1, or 0 where the pair failed, which covers nothing.
    same, none = (0.05 + 0.75) / 1.05, 0.05 / 1.05
    roots = np.sqrt([120, 30, 60]) / 2
    matches = [
        same * (1.0 if n < 5 else none) * roots[: 3 if n < 5 else 2].sum() / 3 for n in range(8)
    ]
    quality = tuple(float(n) for n in (9, 8, 7, 6, 5, 3, 2, 1))
    figures = [{"registered_images": 18} for _ in quality]
    made = reconstructed(*figures).with_columns(pl.Series("model_quality", quality))
    found = relate_outcomes(Stored(measured, made))
    at = (found.features.index("links_x_coverage"), found.outcomes.index("model_quality"))
    expected = [
        same * (1.0 if n < 5 else none) * (0.1 + n / 100 + 0.2 + (0.3 if n < 5 else 0.0)) / 3
        for n in range(8)
    ]
    np.testing.assert_allclose(found.feature_values[:, at[0]], expected)
    np.testing.assert_allclose(found.feature_values[:, found.features.index(LINK_QUALITY)], matches)
    assert found.spearman[at] == pytest.approx(spearmanr(expected, quality).statistic)
    # A table from elsewhere need not have all that links need.
    some = relate_outcomes(Stored(measured.drop("reference_turn"), made))
    assert set(found.features) - set(some.features) == {"links_x_coverage", LINK_QUALITY}


def test_without_a_reference_there_are_no_links() -> None:
    assert "links_x_coverage" not in relate_outcomes(Stored(MEASURED, MODELS)).features


def test_the_table_has_a_row_for_each_pair_of_figures() -> None:
    found = relate_outcomes(Stored(MEASURED, MODELS))
    frame = found.frame()
    assert len(frame) == len(found.features) * len(found.outcomes)
    assert frame.columns == ["feature", "outcome", "combinations", "pearson", "spearman"]
    assert frame["spearman"].is_between(-1, 1).all()
    assert "registered_images" not in found.outcomes  # 18 for all


def test_what_few_models_have_is_not_correlated() -> None:
    figures = [
        {"points_3d": points, "rotation_error": float(n) if n < 5 else None}
        for n, points in enumerate(POINTS)
    ]
    known = pl.when(pl.col("detector") != "D0").then(pl.col("inliers") / 400)
    measured = MEASURED.with_columns(known.alias("recall"))
    found = relate_outcomes(Stored(measured, reconstructed(*figures)))
    at = (found.features.index("recall"), found.outcomes.index("rotation_error"))
    assert found.numbers[at] == 4
    assert np.isnan([found.spearman[at], found.pearson[at]]).all()
    assert not np.isnan(found.spearman[found.features.index("inliers"), at[1]])


def test_imported_figures_suffice() -> None:
    few = {name: (0.5 + number, 100 - number, 7) for number, name in enumerate(NAMES)}
    found = relate_outcomes(Stored(MEASURED, models(few)))
    assert found.outcomes == ("points_3d", "reprojection_error")


@pytest.mark.parametrize(
    ("stored", "message"),
    [
        (Stored(MEASURED), "0 combinations"),
        (Stored(MEASURED, models({NAMES[0]: (1, 2, 3), "A-B-C-D": (1, 2, 3)})), "1 combinations"),
        (
            Stored(MEASURED, models({name: (n, n, n) for n, name in enumerate(NAMES[:4])})),
            r"4 combinations .*\b5\b",
        ),
        (Stored(MEASURED, models(dict.fromkeys(NAMES, (1, 2, 3)))), ""),
        (Stored(MEASURED.clear(), MODELS), "rows"),
    ],
)
def test_what_cannot_be_related(stored: Stored, message: str) -> None:
    with pytest.raises(ScoreError, match=message):
        relate_outcomes(stored)


def test_it_is_part_of_the_public_interface() -> None:
    assert aerocues.relate_outcomes is relate_outcomes
