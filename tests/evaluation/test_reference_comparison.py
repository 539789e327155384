"""Rows are compared with the reference of their pair, with and without ground truth."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from aerocues.datasets.dataset import Dataset, Image
from aerocues.evaluation.context import make_context
from aerocues.evaluation.reference_comparison import ReferenceComparison
from aerocues.evaluation.run import run
from aerocues.evaluation.truth_comparison import Matched, TwoViews
from aerocues.methods.arrays import Features, Keypoints
from aerocues.methods.presets import preset_named
from aerocues.pipeline.clock import StageTime
from aerocues.pipeline.features import Described, ImageFeatures
from aerocues.pipeline.reference import FLOW, Reference, ReferenceBuilder
from aerocues.pipeline.reference_flow import Flow
from aerocues.pipeline.reference_source import ReferenceSource
from aerocues.pipeline.verification import Model
from aerocues.processes.call import NO_PAIR
from aerocues.results.schema import PIXEL_THRESHOLDS, REFERENCE, empty_row
from tests.evaluation.inline import InlineEngine
from tests.evaluation.scenes import (
    assert_same_rows,
    rows_of,
    shift_of_strip,
    strip,
    write_dataset,
)
from tests.made_once import made_once
from tests.methods.pictures import textured
from tests.reconstruction.scenes import write_scene

FEW = "ORB-ORB-HAM-BF,AKAZE-SIFT-L2-BF,GFTT-BRIEF-HAM-BF,STAR-LATCH-HAM-BF"
DERIVED = ("ref_matches@1", "ref_matches@3", "seconds_per_1k_ref_matches")


@pytest.fixture(scope="module")
def plane(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    truth = shift_of_strip()
    return write_dataset(tmp_path_factory.mktemp("plane"), strip(3), homographies=[truth, truth])


@pytest.fixture(scope="module")
def rows(plane: Dataset, tmp_path_factory: pytest.TempPathFactory) -> pl.DataFrame:
    def make(folder: Path) -> pl.DataFrame:
        return run(plane, FEW, folder, engine=InlineEngine(), timing="shared").table()

    return made_once(tmp_path_factory, "compared-with-reference", make)[1]


def test_a_reference_says_of_matches_what_the_truth_says(rows: pl.DataFrame) -> None:
    assert rows["reference"].to_list() == ["flow"] * 8
    assert (rows["reference_agreement"] > 0.9).all()
    assert (rows["reference_turn"] < 1).all()
    for t in PIXEL_THRESHOLDS:
        for figure in ("precision", "matching_score"):
            said, true = rows[f"ref_{figure}@{t}"], rows[f"gt_{figure}@{t}"]
            np.testing.assert_allclose(said, true, atol=0.03 if t > 1 else 0.12)
    np.testing.assert_allclose(rows["ref_repeatability"], rows["gt_repeatability"], atol=0.05)


def test_counts_and_costs_follow_from_the_shares(rows: pl.DataFrame) -> None:
    for t in (1, 3):
        expected = rows[f"ref_precision@{t}"] * rows["matches"]
        np.testing.assert_allclose(rows[f"ref_matches@{t}"], expected)
    seconds = 1000 * rows["total_seconds"] / rows["ref_matches@3"]
    np.testing.assert_allclose(rows["seconds_per_1k_ref_matches"], seconds)
    # Of 240 columns the second image shows 231; no match lies in the last column of cells.
    assert (rows["coverage"] > 0.2).all()
    assert (rows["coverage"] <= 1).all()


@pytest.mark.slow
def test_relief_is_judged_without_its_depth(tmp_path: Path) -> None:
    pairs = [("view_0.png", "view_1.png")]
    dataset = write_scene(tmp_path / "views", [(-3.0, 0.0), (3.0, 0.0)], pairs=pairs)
    few = "SIFT-SIFT-L2-BF,ORB-ORB-HAM-BF,STAR-LATCH-HAM-BF"
    table = run(dataset, few, tmp_path / "r", engine=InlineEngine(), timing="shared").table()
    np.testing.assert_allclose(table["ref_precision@3"], table["gt_precision@3"], atol=0.05)
    np.testing.assert_allclose(table["ref_repeatability"], table["gt_repeatability"], atol=0.1)


@pytest.mark.parametrize(
    ("right", "inliers", "denied"),
    [(20, 20, False), (2, 20, False), (1, 20, True), (0, 8, True), (1, 8, False), (0, 0, False)],
)
def test_a_model_of_which_hardly_anything_is_right_is_denied(
    views: Dataset, right: int, inliers: int, denied: bool
) -> None:
    """Matches of the identity: `right` of the inliers, and five more that are none."""

    class Same(ReferenceSource):
        def reference(self, first: Image, second: Image, pair: int = NO_PAIR) -> Reference:
            still = np.zeros((180, 240, 2), np.int16)
            return Reference(FLOW, 1.0, Flow(np.eye(3), still, np.eye(3)))

    comparison = ReferenceComparison(views, Same(), 0.1)
    comparison.begin_pair(views.pairs[0])
    points = np.random.default_rng(0).uniform(10, 170, (25, 2)).astype(np.float32)
    moved = points + np.where(np.arange(25) < right, 2.9, 3.1)[:, None] * (0, 1)
    features = Features(Keypoints.from_xy(points), np.zeros((25, 1), np.uint8))
    image = ImageFeatures(
        views.images[0], views.images[0].read(), features.keypoints, StageTime(0, 0)
    )
    described = Described(features, StageTime(0, 0))
    both = TwoViews(views.pairs[0], (image, image), (described, described))
    found = Matched(points, moved.astype(np.float32), np.arange(25))
    model = Model(np.eye(3) if inliers else None, np.arange(25) < inliers)
    row = empty_row()
    assert comparison.compare(row, both, found, model) is denied
    assert row["ref_precision@3"] == right / 25
    assert row["ref_repeatability"] == 1
    assert comparison.compare(row, both, found, None) is False


def test_images_without_anything_in_common_have_no_figures(tmp_path: Path) -> None:
    pictures = {f"{seed}.png": textured(240, 180, seed=seed) for seed in (8, 9)}
    dataset = write_dataset(tmp_path / "images", pictures)
    table = run(dataset, FEW, tmp_path / "r", engine=InlineEngine(), timing="shared").table()
    assert table["reference"].n_unique() == 1
    assert table["reference"][0] != "flow"
    names = [column.name for column in REFERENCE if column.name.startswith("ref_")]
    for name in ("reference_turn", "coverage", *names, *DERIVED):
        assert table[name].null_count() == len(table)


@pytest.mark.slow
def test_rows_that_failed_tell_of_the_reference_too(tmp_path: Path) -> None:
    pictures = strip(2)
    dataset = write_dataset(tmp_path / "images", pictures)
    table = run(
        dataset, "MSER-LUCID-HAM-BF,STAR-BOOST-HAM-BF", tmp_path / "r", engine=InlineEngine()
    ).table()
    assert table["reference"].to_list() == ["flow"] * len(table)


def test_the_thesis_asks_no_reference_and_keeps_its_keys(
    plane: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def build(*_: object) -> None:
        raise AssertionError("no reference is to be built")

    monkeypatch.setattr(ReferenceBuilder, "build", build)
    table = run(
        plane, FEW, tmp_path / "r", preset="thesis", engine=InlineEngine(), timing="shared"
    ).table()
    for name in (*(column.name for column in REFERENCE), *DERIVED):
        assert table[name].null_count() == len(table)
    assert table["gt_precision@3"].null_count() == 0
    assert not (tmp_path / "r" / "references").exists()
    protocol = make_context(plane, preset_named("thesis")).protocol
    assert protocol.identity() == {
        "measurement_version": 2,
        "seed": 0,
        "verification": asdict(protocol.verification),
        "chance": None,
    }


@pytest.mark.slow
def test_a_reference_is_built_once_for_all_units_and_runs(
    plane: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    built = list[object]()
    build = ReferenceBuilder.build

    def count(*arguments: object) -> object:
        built.append(arguments)
        return build(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(ReferenceBuilder, "build", count)
    first = run(plane, FEW, tmp_path / "r", engine=InlineEngine(), timing="shared").table()
    assert len(built) == 2
    run(plane, "BRISK-BRISK-HAM-BF", tmp_path / "r", engine=InlineEngine(), timing="shared")
    assert len(built) == 2
    again = run(plane, FEW, tmp_path / "other", engine=InlineEngine(), timing="shared").table()
    assert len(built) == 4
    assert_same_rows(rows_of(again), rows_of(first))


@pytest.mark.slow
def test_workers_share_references(plane: Dataset, tmp_path: Path) -> None:
    table = run(plane, FEW, tmp_path / "r", workers=2, timing="shared").table()
    assert len(list((tmp_path / "r" / "references").iterdir())) == 2
    inline = run(plane, FEW, tmp_path / "one", engine=InlineEngine(), timing="shared").table()
    assert_same_rows(rows_of(table), rows_of(inline))
