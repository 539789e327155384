from __future__ import annotations

from pathlib import Path

import pytest

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import Source
from aerocues.datasets.kinds import CATALOG
from aerocues.errors import ArgumentError, DatasetError


def test_the_catalog_is_complete() -> None:
    names = [kind.name for kind in CATALOG]
    assert names == [
        "synthetic", "synthetic-extended", "oxford", "hpatches", "uav", "flight", "simulated",
        "airsim", "video", "folder",
    ]  # fmt: skip
    for kind in CATALOG:
        assert all([kind.pairs, kind.ground_truth, kind.needs, kind.layout, kind.where, kind.terms])


def test_geometry_and_number_of_pairs_agree_with_the_catalog() -> None:
    for kind in CATALOG[:2]:
        dataset = open_dataset(kind.name)
        assert str(len(dataset.pairs)) in kind.pairs
        assert dataset.geometry == kind.geometry
        assert dataset.name == kind.name


@pytest.mark.parametrize(
    ("spec", "said"),
    [
        ("oxfrd:somewhere", r"\boxfrd\b.*\boxford\b"),
        ("nosuch", "nosuch"),
        ("hpatch", "hpatches"),
        ("/no/such/place", r"synthetic\[:IMAGE\], .*flight:DIR"),
        ("oxford", "oxford:DIR"),
        ("flight:", "flight:DIR"),
        ("uav:/no/such/place", "/no/such/place"),
        ("synthetic:/no/such.png", r"/no/such\.png: No such file"),
    ],
)
def test_what_cannot_be_opened_says_why(spec: str, said: str) -> None:
    with pytest.raises(DatasetError, match=said):
        open_dataset(spec)


def test_a_file_is_no_dataset(image_folder: Path) -> None:
    with pytest.raises(DatasetError, match="synthetic:"):
        open_dataset(str(image_folder / "img2.png"))


def test_options_that_make_no_sense(image_folder: Path) -> None:
    with pytest.raises(DatasetError, match="`pairs`"):
        open_dataset("synthetic", pairs="exhaustive")
    with pytest.raises(ArgumentError, match="`max_pairs`"):
        open_dataset("synthetic", max_pairs=0)
    with pytest.raises(ArgumentError, match="`max_width`"):
        open_dataset(str(image_folder), max_width=3)
    with pytest.raises(ArgumentError, match="histogram"):
        open_dataset(str(image_folder), equalize="loud")


def test_a_width_of_0_is_that_of_the_images() -> None:
    whole, usual = (open_dataset("synthetic", max_width=width) for width in (0, None))
    assert dict(whole.settings)["max_width"] == "full"
    assert whole.source == usual.source
    assert whole.images[0].source == usual.images[0].source


def test_a_folder_called_like_a_kind(
    image_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    image_folder.rename(tmp_path / "oxford")
    monkeypatch.chdir(tmp_path)
    assert open_dataset("oxford").name == "oxford"
    assert open_dataset("oxford").geometry == "epipolar"
    assert open_dataset("folder:oxford").name == "oxford"


def test_limit_keeps_the_first_pairs_and_their_images() -> None:
    dataset = open_dataset("synthetic", max_pairs=2)
    assert [image.name for image in dataset.images] == [
        "original",
        "rotation_015",
        "rotation_030",
    ]
    assert len(dataset.pairs) == 2


def test_sequences_are_globs() -> None:
    dataset = open_dataset("synthetic", sequences=["SCALE", "int*"], max_pairs=7)
    whole = {(p.image_1, p.image_2): p.index for p in open_dataset("synthetic").pairs}
    assert len(dataset.pairs) == 7
    assert [p.index for p in dataset.pairs] == [whole[p.image_1, p.image_2] for p in dataset.pairs]
    assert dataset.pair(dataset.pairs[-1].index) is dataset.pairs[-1]
    assert dataset.pairs[0].image_2 == "scale_0.50"
    assert {p.sequence for p in dataset.pairs} == {"scale", "intensity"}
    with pytest.raises(DatasetError, match="rotation, scale, intensity"):
        open_dataset("synthetic", sequences=["tilt"])


def test_sequences_may_be_one_text_with_commas() -> None:
    for text in ("scale", "SCALE, int*", "scale,,intensity,"):
        names = [name.strip() for name in text.split(",") if name]
        expected = open_dataset("synthetic", sequences=names)
        dataset = open_dataset("synthetic", sequences=text)
        assert [p.index for p in dataset.pairs] == [p.index for p in expected.pairs]
        assert len(dataset.pairs) < 20
    with pytest.raises(DatasetError, match="tilt, turn"):
        open_dataset("synthetic", sequences="tilt,turn")


def test_a_dataset_tells_how_to_open_it_again(
    image_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(image_folder.parent)
    first = open_dataset(image_folder.name, max_width=64, max_pairs=1)
    assert first.source == Source(str(image_folder), max_width=64, max_pairs=1)
    monkeypatch.chdir(tmp_path)
    again = open_dataset(**vars(first.source))
    assert again.source == first.source
    assert [pair.image_2 for pair in again.pairs] == [pair.image_2 for pair in first.pairs]
    assert first.images[0].source.content_key() == again.images[0].source.content_key()


def test_the_place_of_a_pairs_file_is_kept(
    image_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = [image.name for image in open_dataset(str(image_folder)).images]
    (tmp_path / "pairs.txt").write_text(f'"{names[0]}" "{names[-1]}"')
    monkeypatch.chdir(tmp_path)
    source = open_dataset(f"flight:{image_folder}", pairs="pairs.txt").source
    assert source == Source(f"flight:{image_folder}", pairs=str(tmp_path / "pairs.txt"))


def test_what_is_drawn_has_no_place() -> None:
    source = open_dataset("synthetic", sequences=["scale", "rot*"]).source
    assert source == Source("synthetic", sequences="scale,rot*")
