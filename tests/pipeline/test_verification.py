from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from aerocues.pipeline.clock import Clock
from aerocues.pipeline.correspondence import transfer
from aerocues.pipeline.protocol import ChanceTest, MeasurementProtocol, Verification
from aerocues.pipeline.verification import (
    Model,
    Verdict,
    Verifier,
    estimate_homography,
    magsac_parameters,
)

Points = NDArray[np.float32]
SETTINGS = Verification()
WIDTH, HEIGHT = 1000, 665


def cross(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    x, y, z = vector
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def two_views(
    inliers: int, outliers: int, noise: float = 0.3, seed: int = 0
) -> tuple[Points, Points, NDArray[np.float64]]:
    """Projections of points in space by two cameras, wrong matches after them, and the true F."""
    random = np.random.default_rng(seed)
    calibration = np.array([[800.0, 0, WIDTH / 2], [0, 800.0, HEIGHT / 2], [0, 0, 1]])
    rotation, _ = cv2.Rodrigues(np.array([0.03, -0.10, 0.05]))
    translation = np.array([1.0, 0.2, 0.1])
    first = random.uniform((0, 0), (WIDTH, HEIGHT), (inliers, 2))
    depth = random.uniform(4, 12, inliers)
    rays = np.column_stack([first, np.ones(inliers)]) @ np.linalg.inv(calibration).T
    moved = (rays * depth[:, None]) @ rotation.T + translation
    projected = moved @ calibration.T
    second = projected[:, :2] / projected[:, 2:]
    first, second = (points + random.normal(0, noise, points.shape) for points in (first, second))
    wrong = random.uniform((0, 0), (WIDTH, HEIGHT), (2, outliers, 2))
    inverse = np.linalg.inv(calibration)
    fundamental = inverse.T @ cross(translation) @ rotation @ inverse
    return (
        np.concatenate([first, wrong[0]]).astype(np.float32),
        np.concatenate([second, wrong[1]]).astype(np.float32),
        fundamental,
    )


def sampson(
    points_1: Points, points_2: Points, fundamental: NDArray[np.float64]
) -> NDArray[np.float64]:
    first, second = (np.column_stack([p, np.ones(len(p))]) for p in (points_1, points_2))
    lines_2, lines_1 = first @ fundamental.T, second @ fundamental
    product = (second * lines_2).sum(axis=1)
    gradient = (lines_2[:, :2] ** 2).sum(axis=1) + (lines_1[:, :2] ** 2).sum(axis=1)
    distances: NDArray[np.float64] = np.abs(product) / np.sqrt(gradient)
    return distances


def verify(
    points_1: Points, points_2: Points, *, chance: ChanceTest | None = None, seed: int = 0
) -> Verdict:
    """Verify matches of which those in front have the smallest descriptor distance."""
    protocol = MeasurementProtocol(seed=seed, verification=SETTINGS, chance=chance)
    verifier = Verifier(protocol, "epipolar", Clock())
    return verifier.verify(points_1, points_2, np.arange(len(points_1)))


def fundamental_of(points_1: Points, points_2: Points) -> Model:
    return verify(points_1, points_2).model


@pytest.mark.parametrize("seed", range(4))
def test_inliers_of_a_known_geometry_are_found(seed: int) -> None:
    first, second, truth = two_views(200, 130, seed=seed)
    model = fundamental_of(first, second)
    assert model.matrix is not None
    assert model.inliers[:200].mean() > 0.97
    # A wrong match that lies on its epipolar line by chance cannot be told from a true one.
    by_chance = sampson(first[200:], second[200:], truth) < SETTINGS.threshold + 2
    assert model.inliers[200:][~by_chance].mean() < 0.03
    assert model.matrix.dtype == np.float64
    assert model.inliers.dtype == bool
    assert model.count == model.inliers.sum()
    points = sampson(first[:200], second[:200], model.matrix)
    assert np.median(points) < 0.6


@pytest.mark.parametrize("seed", range(5))
def test_parameters_equal_the_default_of_opencv_byte_for_byte(seed: int) -> None:
    first, second, _ = two_views(60 + 40 * seed, 50, noise=0.8, seed=seed)
    default, default_mask = cv2.findFundamentalMat(first, second, cv2.USAC_MAGSAC)
    matrix, mask = cv2.findFundamentalMat(first, second, magsac_parameters(SETTINGS))
    assert matrix.tobytes() == default.tobytes()
    assert mask.tobytes() == default_mask.tobytes()
    verdict = verify(first, second)
    assert verdict.model.matrix is not None
    assert verdict.model.matrix.tobytes() == default.tobytes()
    assert verdict.model.inliers.tolist() == default_mask.ravel().astype(bool).tolist()
    assert verdict.sampling == "uniform"


def test_verification_repeats_exactly_whatever_the_seed_of_opencv() -> None:
    first, second, _ = two_views(80, 100)
    found = [verify(first, second, seed=seed).model.inliers.tobytes() for seed in (0, 1, 99)]
    assert len(set(found)) == 1


def test_settings_reach_opencv() -> None:
    parameters = magsac_parameters(Verification(1.5, 0.999, 5000))
    assert parameters.threshold == 1.5
    assert parameters.confidence == 0.999
    assert parameters.maxIterations == 5000
    first, second, _ = two_views(200, 0, noise=1.0)
    counts = []
    for threshold in (0.5, 1.5, 3.0):
        protocol = MeasurementProtocol(verification=Verification(threshold), chance=None)
        verifier = Verifier(protocol, "epipolar", Clock())
        counts.append(verifier.verify(first, second, np.arange(200)).model.count)
    assert counts[0] < counts[1] < counts[2]


@pytest.mark.parametrize("place", [(0.0, 0.0), (123.0, 45.0)])
def test_identical_points_give_no_model(place: tuple[float, float]) -> None:
    same = np.tile(np.array(place, np.float32), (30, 1))
    model = fundamental_of(same, same)
    assert model.matrix is None
    assert model.count == 0
    assert len(model.inliers) == 30


def test_points_on_one_line_give_no_model_or_a_finite_one() -> None:
    line = np.column_stack([np.arange(40), 2 * np.arange(40)]).astype(np.float32)
    model = fundamental_of(line, line + 5)
    assert model.matrix is None or np.isfinite(model.matrix).all()


@pytest.mark.parametrize("shift", [9, -4])
def test_a_pure_shift_on_whole_pixels_is_judged_and_never_an_error(shift: int) -> None:
    """Every sample may be degenerate, at which OpenCV raises instead of finding nothing."""
    for seed in range(25):
        random = np.random.default_rng(seed)
        first = random.integers(20, 200, (int(random.integers(8, 60)), 2)).astype(np.float32)
        verdict = verify(first, first + np.float32(shift), chance=ChanceTest())
        assert verdict.model.matrix is None or verdict.model.count > 0


def test_opencv_finding_nothing_by_raising_is_no_model(monkeypatch: pytest.MonkeyPatch) -> None:
    def nothing(*arguments: object) -> None:
        raise cv2.error("(-215:Assertion failed) !model.empty() in function 'setModelParameters'")

    def worse(*arguments: object) -> None:
        raise cv2.error("(-215:Assertion failed) points.checkVector(2) >= 0")

    first, second, _ = two_views(30, 0)
    monkeypatch.setattr(cv2, "findFundamentalMat", nothing)
    monkeypatch.setattr(cv2, "findHomography", nothing)
    assert verify(first, second, chance=ChanceTest()).model.matrix is None
    assert estimate_homography(first, second, magsac_parameters(SETTINGS)).matrix is None
    monkeypatch.setattr(cv2, "findFundamentalMat", worse)
    with pytest.raises(cv2.error):
        verify(first, second)


NOT_A_MODEL = [
    (None, None),
    (np.eye(3), None),
    (np.full((3, 3), np.nan), np.ones((8, 1), np.uint8)),
    (np.zeros((3, 3)), np.ones((8, 1), np.uint8)),
    (np.outer([1.0, 2, 3], [4.0, 5, 6]), np.ones((8, 1), np.uint8)),
    (np.eye(3), np.zeros((8, 1), np.uint8)),
    (np.vstack([np.eye(3), np.eye(3)]), np.ones((8, 1), np.uint8)),
]


@pytest.mark.parametrize("raw", NOT_A_MODEL)
def test_what_is_no_single_matrix_of_rank_two_is_no_model(
    raw: tuple[object, object], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cv2, "findFundamentalMat", lambda *arguments: raw)
    first, second, _ = two_views(8, 0)
    for chance in (None, ChanceTest()):
        verdict = verify(first, second, chance=chance)
        assert verdict.model.matrix is None
        assert verdict.model.inliers.tolist() == [False] * 8
        assert not verdict.passed


def test_an_exact_homography_is_found() -> None:
    truth = np.array([[1.1, 0.05, 12.0], [-0.04, 0.95, -7.0], [2e-5, 1e-5, 1.0]])
    random = np.random.default_rng(2)
    first = random.uniform((0, 0), (WIDTH, HEIGHT), (60, 2)).astype(np.float32)
    moved = np.column_stack([first, np.ones(60)]) @ truth.T
    second = (moved[:, :2] / moved[:, 2:]).astype(np.float32)
    second[50:] = random.uniform((0, 0), (WIDTH, HEIGHT), (10, 2))
    model = estimate_homography(first, second, magsac_parameters(SETTINGS))
    assert model.matrix is not None
    np.testing.assert_allclose(model.matrix / model.matrix[2, 2], truth, rtol=1e-3, atol=1e-6)
    assert model.inliers[:50].all()
    assert model.count <= 52


@pytest.mark.parametrize("count", [0, 1, 3])
def test_a_homography_needs_four_points(count: int) -> None:
    points = np.random.default_rng(0).uniform(0, 100, (count, 2)).astype(np.float32)
    model = estimate_homography(points, points, magsac_parameters(SETTINGS))
    assert model.matrix is None
    assert model.inliers.shape == (count,)


@pytest.mark.parametrize("seed", range(6))
def test_true_matches_beat_chance_and_random_ones_do_not(seed: int) -> None:
    first, second, _ = two_views(60, 100, seed=seed)
    verdict = verify(first, second, chance=ChanceTest())
    assert verdict.passed
    assert verdict.chance_max is not None
    assert verdict.model.count > ChanceTest().factor * verdict.chance_max
    wrong_1, wrong_2, _ = two_views(0, 200, seed=seed)
    verdict = verify(wrong_1, wrong_2, chance=ChanceTest())
    assert not verdict.passed
    assert verify(wrong_1, wrong_2).passed


def test_guided_sampling_finds_few_true_matches_that_come_first() -> None:
    """One in six: uniform samples of seven are hardly ever all right, the nearest are."""
    first, second, _ = two_views(30, 150, seed=3)
    alone = verify(first, second)
    assert alone.sampling == "uniform"
    verdict = verify(first, second, chance=ChanceTest())
    assert verdict.passed
    assert verdict.model.inliers[:30].mean() > 0.8
    shuffled = np.random.default_rng(0).permutation(180)
    protocol = MeasurementProtocol(verification=SETTINGS)
    verifier = Verifier(protocol, "epipolar", Clock())
    mixed = verifier.verify(first[shuffled], second[shuffled], np.argsort(shuffled))
    assert mixed.passed
    # Inliers are told in the order of the matches, not in that of their distances.
    assert mixed.model.inliers[np.argsort(shuffled)][:30].mean() > 0.8


def views_of_a_plane(
    true: int, wrong: int, seed: int
) -> tuple[Points, Points, NDArray[np.float64]]:
    """Matched points of two views of a plane, the true ones first, and the homography."""
    generator = np.random.default_rng(seed)
    homography = np.array([[0.9, 0.2, 30], [-0.15, 1.1, 40], [2e-4, -1e-4, 1]])
    first = generator.uniform(0, 800, (true + wrong, 2))
    second = transfer(first, homography)
    second[true:] = generator.uniform(0, 800, (wrong, 2))
    return first.astype(np.float32), second.astype(np.float32), homography


def test_few_true_matches_of_a_plane_are_found_by_its_homography() -> None:
    """One in forty, among the nearest 80 descriptors: mostly too few for a fundamental matrix."""
    protocol = MeasurementProtocol(verification=SETTINGS)
    verifier = Verifier(protocol, "homography", Clock())
    found_by = []
    for seed in range(5):
        first, second, homography = views_of_a_plane(24, 936, seed)
        generator = np.random.default_rng(seed)
        order = np.concatenate([generator.permutation(80), 80 + generator.permutation(880)])
        verdict = verifier.verify(first, second, order)
        assert verdict.passed
        found_by.append(verdict.sampling)
        if verdict.sampling == "homography":
            assert verdict.model.inliers[:24].all()
            assert verdict.model.count < 40
            assert verdict.model.matrix is not None
            moved = transfer(first[:24], verdict.model.matrix)
            np.testing.assert_allclose(moved, transfer(first[:24], homography), atol=1.5)
        wrong_1, wrong_2, _ = views_of_a_plane(0, 960, seed)
        assert not verifier.verify(wrong_1, wrong_2, order).passed
    assert "homography" in found_by


def test_the_chance_test_is_seeded_and_counts_as_it_says() -> None:
    first, second, _ = two_views(100, 100)
    one, again = (verify(first, second, chance=ChanceTest(), seed=5) for _ in range(2))
    assert (one.chance_mean, one.chance_max) == (again.chance_mean, again.chance_max)
    assert one.chance_mean is not None
    assert one.chance_max is not None
    assert 0 < one.chance_mean <= one.chance_max < 100
    single = verify(first, second, chance=ChanceTest(shuffles=1), seed=5)
    assert single.chance_mean == single.chance_max
    assert verify(first, second).chance_mean is None
    means = {verify(first, second, chance=ChanceTest(n)).chance_mean for n in (1, 2, 3)}
    assert len(means) > 1


@pytest.mark.parametrize("true", [0, 12, 20, 40])
def test_the_verdict_needs_no_shuffled_set_after_one_that_is_not_beaten(true: int) -> None:
    protocol = MeasurementProtocol(verification=SETTINGS)
    for seed in range(6):
        first, second, _ = two_views(true, 160 - true, seed=seed)
        one, other = (
            Verifier(protocol, "epipolar", Clock(), count_all=count_all).verify(
                first, second, np.arange(160)
            )
            for count_all in (True, False)
        )
        assert (one.passed, one.sampling, one.status) == (
            other.passed,
            other.sampling,
            other.status,
        )
        np.testing.assert_array_equal(one.model.inliers, other.model.inliers)


def test_the_shuffled_estimations_are_not_timed() -> None:
    first, second, _ = two_views(100, 100)
    verdict = verify(first, second, chance=ChanceTest(shuffles=200))
    alone = verify(first, second)
    assert 0 < verdict.time.cpu < 50 * max(alone.time.cpu, 1e-3)
