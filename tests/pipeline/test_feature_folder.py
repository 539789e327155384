"""Features on disk serve later runs, and only where nothing that decides them has changed."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aerocues.datasets.dataset import Dataset, Image, Pixels
from aerocues.datasets.decoded import DecodedSource
from aerocues.errors import StoreError
from aerocues.evaluation.run import run
from aerocues.methods import plugins
from aerocues.methods.arrays import Features, Keypoints
from aerocues.methods.combination import Combination
from aerocues.methods.plugins import installed_methods, register
from aerocues.methods.presets import Preset
from aerocues.pipeline import feature_folder
from aerocues.pipeline.clock import Clock, StageTime
from aerocues.pipeline.feature_folder import FeatureFolder, checked_folder
from aerocues.pipeline.feature_source import FeatureSource
from aerocues.pipeline.features import Described, FeatureExtractor
from aerocues.pipeline.protocol import MeasurementProtocol
from tests.evaluation.inline import InlineEngine
from tests.evaluation.scenes import PLAIN, assert_same_rows, rows_of

FEW = "ORB-ORB-HAM-BF,ORB-BRIEF-HAM-FLANN,AKAZE-SIFT-L2-BF,AKAZE-AKAZE-HAM-BF"


class Count:
    """Counts images that are detected in and described."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.calls = {"detect": 0, "describe": 0}
        for name in self.calls:
            monkeypatch.setattr(FeatureExtractor, name, self._counted(name))

    def _counted(self, name: str) -> Any:
        original = getattr(FeatureExtractor, name)

        def count(*arguments: Any) -> Any:
            self.calls[name] += 1
            return original(*arguments)

        return count

    def taken(self) -> tuple[int, int]:
        numbers = (self.calls["detect"], self.calls["describe"])
        self.calls.update(detect=0, describe=0)
        return numbers


def measure(dataset: Dataset, output: Path, features: Path | None, **options: Any) -> Any:
    settings: dict[str, Any] = {"timing": "shared", "preset": PLAIN, **options}
    combinations = settings.pop("combinations", FEW)
    return run(
        dataset, combinations, output, features=features, engine=InlineEngine(), **settings
    ).table()


@pytest.fixture(scope="module")
def stored(views: Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The features of a run; not to be changed."""
    folder = tmp_path_factory.mktemp("stored")
    measure(views, folder / "results", folder / "features")
    return folder / "features"


@pytest.mark.slow
def test_another_run_finds_what_one_kept(
    views: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    count, kept = Count(monkeypatch), tmp_path / "features"
    without = measure(views, tmp_path / "a", None)
    assert count.taken() == (8, 16)
    first = measure(views, tmp_path / "b", kept)
    assert count.taken() == (8, 16)
    second = measure(views, tmp_path / "c", kept)
    assert count.taken() == (0, 0)
    for table in (first, second):
        assert_same_rows(rows_of(table), rows_of(without))
    seconds = [name for name in first.columns if name.startswith(("detect", "describe"))]
    assert first.select(seconds).equals(second.select(seconds))
    files = {path.parent.name for path in kept.rglob("*.npz")}
    assert files == {"ORB", "ORB-ORB", "ORB-BRIEF", "AKAZE", "AKAZE-SIFT", "AKAZE-AKAZE"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "taken"),
    [
        ({"combinations": "ORB-ORB-HAM-FLANN"}, (0, 0)),
        ({"preset": Preset("strict", "s", False, thresholds={"ORB-ORB": 1.0})}, (0, 0)),
        ({"timing": "estimated"}, (0, 0)),
        ({"timing": "exclusive"}, (8, 16)),
        ({"seed": 1}, (8, 16)),
        ({"max_keypoints": 100}, (8, 16)),
        ({"preset": Preset("b", "b", False, {}, {"BRIEF": {"bytes": 32}})}, (0, 4)),
        ({"preset": Preset("o", "o", False, {"ORB": {"nlevels": 3}})}, (4, 8)),
    ],
)
def test_what_decides_features_is_part_of_their_name(
    views: Dataset,
    stored: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    options: dict[str, Any],
    taken: tuple[int, int],
) -> None:
    count, kept = Count(monkeypatch), shutil.copytree(stored, tmp_path / "features")
    measure(views, tmp_path / "b", kept, **options)
    assert count.taken() == taken


@pytest.mark.slow
def test_damaged_files_are_made_again(
    views: Dataset, stored: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = shutil.copytree(stored, tmp_path / "features")
    before = measure(views, tmp_path / "a", None)
    for number, file in enumerate(sorted(kept.rglob("*.npz"))):
        file.write_bytes(file.read_bytes()[: 40 * (number % 3)])
    count = Count(monkeypatch)
    after = measure(views, tmp_path / "b", kept)
    assert count.taken() == (8, 16)
    assert_same_rows(rows_of(after), rows_of(before))


def test_a_full_disk_costs_only_what_would_have_been_kept(
    views: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(feature_folder, "write_arrays", full)
    table = measure(views, tmp_path / "a", tmp_path / "features", preset="default")
    assert set(table["status"]) == {"ok"}
    [message] = set(table["message"])
    assert str(tmp_path / "features") in message
    assert "No space left on device" in message


def test_a_folder_that_cannot_be_made_is_told_before_anything_is_measured(
    views: Dataset, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match="file"):
        measure(views, tmp_path / "r", tmp_path / "file")
    with pytest.raises(StoreError, match="features"):
        measure(views, tmp_path / "r", tmp_path / "file" / "features")
    assert not (tmp_path / "r").exists()


def test_times_come_back_as_they_were(views: Dataset, tmp_path: Path) -> None:
    from tests.evaluation.test_plan import context_of

    context = context_of(views)
    place = checked_folder(tmp_path)
    folder = FeatureFolder(place, context.methods, context.protocol, context.machine)
    image = views.images[0]
    keypoints = Keypoints.from_xy(np.random.default_rng(0).random((5, 2)))
    for taken in (StageTime(1.0, 0.5), StageTime(1.0, 0.5, 3.0, 3, 0.1), StageTime(0.0, 0.0, 0.0)):
        folder.keep_keypoints(image, "ORB", keypoints, taken)
        found = folder.keypoints(image, "ORB")
        assert found is not None
        assert found[1] == taken
        assert np.array_equal(found[0].xy, keypoints.xy)
        rows = np.arange(160, dtype=np.uint8).reshape(5, 32)
        features = Features(keypoints, rows, (640, 480))
        folder.keep_described(image, "ORB", "ORB", Described(features, taken))
        described = folder.described(image, "ORB", "ORB")
        assert described is not None
        assert described.time == taken
        assert described.features.image_size == (640, 480)
        assert np.array_equal(described.features.descriptors, rows)
        assert described.features.descriptors.dtype == np.uint8
    assert folder.described(image, "ORB", "BRIEF") is None


class Extractor:
    """Keypoints and descriptors at once."""

    dtype = "float32"

    def extract(self, image: Any) -> Features:
        xy = np.array([[5.0, 5.0], [9.0, 7.0]])
        return Features(Keypoints.from_xy(xy), np.eye(2, dtype=np.float32))


def test_an_extractor_that_was_interrupted_after_its_keypoints_begins_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plugins, "_REGISTERED", {})
    register("extractor", "OWN", Extractor)
    image = Image("1", DecodedSource(Pixels(np.zeros((20, 20, 3), np.uint8))))
    combination = Combination.parse("OWN-OWN-L2-BF")

    def features() -> Features:
        methods, protocol = installed_methods(), MeasurementProtocol()
        folder = FeatureFolder(tmp_path, methods, protocol, "here")
        source = FeatureSource(methods, protocol, Clock(0), folder=folder)
        return source.features(image, combination).features

    features()
    [kept] = (tmp_path / "OWN-OWN").iterdir()
    kept.unlink()
    assert features().descriptors.tolist() == np.eye(2).tolist()
