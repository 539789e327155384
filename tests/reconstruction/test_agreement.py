"""Models against GPS, with made-up positions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from aerocues.methods.combination import Combination
from aerocues.reconstruction.agreement import outvoted
from aerocues.reconstruction.protocol import Requirements
from aerocues.reconstruction.truth import TruePositions, locate
from aerocues.results.clouds import Cloud

Array = NDArray[np.float64]
REQUIREMENTS = Requirements()
NAMES = [f"image_{number:02d}" for number in range(20)]
# Four strips of five images: 160 x 120 m at a height of 60 m.
FLOWN = np.array([(40.0 * (i % 5), 40.0 * (i // 5), 60.0 + i % 3) for i in range(20)])
SIFT, ORB, AKAZE, KAZE = (
    Combination.parse(name)
    for name in ("SIFT-SIFT-L2-BF", "ORB-ORB-HAM-BF", "AKAZE-AKAZE-HAM-BF", "KAZE-KAZE-L2-BF")
)
DRIFT = np.linspace(0, 1, 20)[:, None]
WRONG = FLOWN + DRIFT**2 * np.array([90.0, -60.0, 80.0])


def model(seed: int, noise: float = 0.2, bend: float = 0.0) -> Array:
    """Centres as a model has them: in its own frame, and not exact."""
    generator = np.random.default_rng(seed)
    rotation = Rotation.random(random_state=seed).as_matrix()
    centres = FLOWN + generator.normal(scale=noise, size=FLOWN.shape)
    centres[:, 2] += bend * (centres[:, 0] / 160) ** 2
    return 0.03 * centres @ rotation.T + generator.normal(size=3)


def row_and_cloud(centres: Array, gps: Array) -> tuple[dict[str, Any], Cloud]:
    """What judging a model comes to, as far as positions are concerned."""
    truth = TruePositions("gps", dict(zip(NAMES, gps, strict=True)))
    located = locate(dict(zip(NAMES, centres, strict=True)), truth, REQUIREMENTS)
    assert located is not None
    placed = 20 - len(located.far)
    row = {
        "status": "ok" if placed >= 16 else "misplaced",
        "message": None,
        "images": 20,
        "registered_images": 20,
        "truth": located.truth.source,
        "position_rmse": 1.0,
        "placed_images": placed,
    }
    nothing = np.zeros(0, np.float32)
    cloud = Cloud(
        points=np.zeros((0, 3), np.float32),
        colours=np.zeros((0, 3), np.uint8),
        errors=nothing,
        track_lengths=np.zeros(0, np.int32),
        distances=nothing,
        centres=located.frame.apply(centres).astype(np.float32),
        rotations=np.tile(np.eye(3, dtype=np.float32), (20, 1, 1)),
        names=np.array(NAMES),
        positions=gps.astype(np.float32),
        view=np.array([500, 1000, 750], np.float32),
        unit="m",
    )
    return row, cloud


def voted(models: Mapping[Combination, Array], gps: Array) -> dict[Combination, dict[str, Any]]:
    made = {name: row_and_cloud(centres, gps) for name, centres in models.items()}
    rows = {name: row for name, (row, _) in made.items()}
    return outvoted(rows, lambda name: made[name][1], REQUIREMENTS)


def test_models_that_agree_outvote_gps() -> None:
    rows = voted({SIFT: model(1), ORB: model(2), AKAZE: model(3)}, WRONG)
    for row in rows.values():
        assert (row["status"], row["truth"], row["placed_images"]) == ("ok", "models", 20)
        assert row["position_rmse"] is None
        assert row["message"].startswith("GPS and models disagree: 3 models agree")


def test_a_model_that_agrees_with_none_stays_misplaced() -> None:
    torn = model(4)
    torn[:8] += 5.0
    rows = voted({SIFT: model(1), ORB: model(2), AKAZE: model(3), KAZE: torn}, WRONG)
    assert [row["status"] for row in rows.values()] == ["ok", "ok", "ok", "misplaced"]
    assert rows[KAZE]["message"].startswith("8 of 20 cameras are not where")


@pytest.mark.parametrize(
    "models",
    [
        {SIFT: model(1), ORB: model(2)},
        {SIFT: model(1), Combination("SIFT", "SIFT", "L2", "FLANN"): model(2)}
        | {Combination("SIFT", "BRISK", "HAM", "BF"): model(3)},
        {SIFT: model(1), ORB: model(2, noise=8.0), AKAZE: model(3, noise=8.0)},
    ],
    ids=["two only", "one detector", "no agreement"],
)
def test_gps_holds_where_models_do_not_confirm_each_other(
    models: dict[Combination, Array],
) -> None:
    rows = voted(models, WRONG)
    assert {row["status"] for row in rows.values()} == {"misplaced"}
    assert {row["truth"] for row in rows.values()} == {"gps"}


def test_gps_holds_where_it_confirms_as_many_models() -> None:
    def torn(seed: int) -> Array:
        centres = model(seed)
        frame = Rotation.random(random_state=seed).as_matrix()
        centres[10:] += 0.03 * np.array([0.0, 40.0, 0.0]) @ frame.T
        return centres

    models = {SIFT: torn(1), ORB: torn(2), AKAZE: torn(3)}
    confirmed = {
        Combination(name, "SIFT", "L2", "BF"): model(seed)
        for seed, name in enumerate(("KAZE", "MSD", "HL"), 4)
    }
    rows = voted({**models, **confirmed}, FLOWN)
    assert [row["status"] for row in rows.values()] == ["misplaced"] * 3 + ["ok"] * 3


def test_heights_are_judged_apart() -> None:
    heights = FLOWN + np.random.default_rng(8).normal(scale=40, size=(20, 1)) * [0, 0, 1]
    row, _ = row_and_cloud(model(1), heights)
    assert (row["status"], row["truth"], row["placed_images"]) == ("ok", "gps in plan", 20)
    rows = voted({SIFT: model(1), ORB: model(2), AKAZE: model(3)}, heights)
    for each in rows.values():
        assert each["message"].startswith("heights of GPS are left out: 3 models agree")
        assert (each["status"], each["position_rmse"]) == ("ok", 1.0)


def test_good_gps_is_compared_in_all_three_directions() -> None:
    truth = TruePositions("gps", dict(zip(NAMES, FLOWN, strict=True)))
    located = locate(dict(zip(NAMES, model(1), strict=True)), truth, REQUIREMENTS)
    assert located is not None
    assert located.truth.source == "gps"
    assert not located.far
    assert max(located.errors.values()) < 1.0
