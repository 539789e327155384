"""A reference is built once, kept whole, and what is kept equals what is built."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from aerocues.datasets.dataset import Dataset, Image
from aerocues.datasets.decoded import DecodedSource, pixels_of
from aerocues.errors import ImageError
from aerocues.pipeline import reference_folder
from aerocues.pipeline.reference import FLOW, PreparedImage, Reference, ReferenceBuilder
from aerocues.pipeline.reference_folder import ReferenceFolder, reference_key
from aerocues.pipeline.reference_source import ReferenceSource
from aerocues.processes.call import StageCall
from tests.methods.pictures import textured


class Count:
    """Counts images that are prepared, and references that are built."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.prepared = self.built = 0
        prepare, build = ReferenceBuilder.prepare, ReferenceBuilder.build

        def count_image(builder: ReferenceBuilder, pixels: object) -> PreparedImage:
            self.prepared += 1
            return prepare(builder, pixels)  # type: ignore[arg-type]

        def count_reference(
            builder: ReferenceBuilder, first: PreparedImage, second: PreparedImage
        ) -> Reference:
            self.built += 1
            return build(builder, first, second)

        monkeypatch.setattr(ReferenceBuilder, "prepare", count_image)
        monkeypatch.setattr(ReferenceBuilder, "build", count_reference)


def assert_same(got: Reference, expected: Reference) -> None:
    assert (got.verdict, got.agreement) == (expected.verdict, expected.agreement)
    assert (got.flow is None) == (expected.flow is None)
    if got.flow is not None and expected.flow is not None:
        for name, array in vars(expected.flow).items():
            np.testing.assert_array_equal(getattr(got.flow, name), array)
            assert getattr(got.flow, name).dtype == array.dtype
        assert got.turn == expected.turn


def unrelated() -> list[Image]:
    return [
        Image(f"{seed}", DecodedSource(pixels_of(textured(240, 180, seed=seed)))) for seed in (8, 9)
    ]


def test_what_is_kept_equals_what_is_built(views: Dataset, tmp_path: Path) -> None:
    first, second = views.images[:2]
    fresh = ReferenceSource().reference(first, second)
    assert fresh.verdict == FLOW
    writing = ReferenceSource(tmp_path / "references").reference(first, second)
    reading = ReferenceSource(tmp_path / "references").reference(first, second)
    assert_same(writing, fresh)
    assert_same(reading, fresh)
    assert [file.suffix for file in (tmp_path / "references").iterdir()] == [".npz"]


def test_that_there_is_none_is_kept_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first, second = unrelated()
    fresh = ReferenceSource(tmp_path).reference(first, second)
    assert fresh.flow is None
    count = Count(monkeypatch)
    assert_same(ReferenceSource(tmp_path).reference(first, second), fresh)
    assert (count.prepared, count.built) == (0, 0)


def test_neighbouring_pairs_share_the_work_on_an_image(
    views: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    count, announced = Count(monkeypatch), list[StageCall]()
    source = ReferenceSource(tmp_path, announced.append)
    for pair in views.pairs:
        source.reference(views.image(pair.image_1), views.image(pair.image_2), pair.index)
    assert (count.prepared, count.built) == (4, 3)
    source.reference(views.images[0], views.images[1])
    assert count.built == 3
    assert [str(call) for call in announced[:1]] == ["reference flow on view_0.png and view_1.png"]
    assert [call.pair for call in announced] == [0, 1, 2, -1]


def test_a_damaged_file_is_built_again(views: Dataset, tmp_path: Path) -> None:
    first, second = views.images[:2]
    fresh = ReferenceSource(tmp_path).reference(first, second)
    (file,) = tmp_path.iterdir()
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) // 2])
    assert_same(ReferenceSource(tmp_path).reference(first, second), fresh)
    assert file.read_bytes() == whole


def test_where_nothing_can_be_written_it_goes_on(views: Dataset, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    source = ReferenceSource(tmp_path / "file" / "references")
    assert source.reference(views.images[0], views.images[1]).verdict == FLOW
    assert source.problem is not None
    assert "references are kept no longer" in source.problem


def test_an_image_that_cannot_be_read_is_the_reason(
    views: Dataset, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    class Broken:
        def read(self) -> None:
            raise ImageError("b.png cannot be decoded: it is truncated; copy it again")

        def content_key(self) -> str:
            return "broken"

    broken = replace(views.images[1], source=Broken())  # type: ignore[arg-type]
    found = ReferenceSource(tmp_path).reference(views.images[0], broken)
    assert found.flow is None
    assert "truncated" in found.verdict
    assert list(tmp_path.iterdir()) == []  # it may be readable the next time


def test_a_key_is_of_pixels_order_and_versions(
    views: Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second, third = views.images[:3]
    keys = [
        reference_key(first, second),
        reference_key(second, first),
        reference_key(first, third),
    ]
    monkeypatch.setattr(reference_folder, "REFERENCE_VERSION", 1000)
    keys.append(reference_key(first, second))
    monkeypatch.setattr(cv2, "__version__", "another")
    keys.append(reference_key(first, second))
    assert len(set(keys)) == 5
    renamed = replace(first, name="renamed.png")
    assert reference_key(renamed, second) == keys[-1]


def test_a_folder_is_empty_at_first(tmp_path: Path) -> None:
    assert ReferenceFolder(tmp_path / "none").reference("key") is None
