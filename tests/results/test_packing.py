"""A results folder as one file, and back."""

from __future__ import annotations

import gc
import tempfile
import zipfile
from pathlib import Path

import polars as pl
import pytest
from polars.testing import assert_frame_equal

from aerocues.errors import StoreError
from aerocues.results.measured_results import Results
from aerocues.results.store import Store
from aerocues.results.whole_files import parquet_content
from tests.results.test_store import planned, row


@pytest.fixture(autouse=True)
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where temporary folders are made."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


@pytest.fixture
def results(tmp_path: Path) -> Results:
    """A folder with rows of two settings, one of them measured twice, and a reconstruction."""
    store = Store.create(tmp_path / "results")
    before = [row(number, settings_key="before", row_key=f"old-{number}") for number in (1, 2)]
    store.write_plan(planned(before))
    store.write_rows("old", before)
    store.write_plan(planned([row(1), row(2), row(3)]))
    store.write_run({"settings_key": "now", "machine": {"name": "board"}})
    store.write_rows("a", [row(1, matches=4), row(2, status="chance")])
    store.write_rows("b", [row(1, matches=5, measured_at=2.0)])
    store.write_reconstructions(
        pl.DataFrame([{name: row(1)[name] for name in ("dataset", "detector", "descriptor")}])
    )
    return Results(store.folder)


def test_a_packed_folder_is_read_like_the_folder(results: Results, tmp_path: Path) -> None:
    packed = Results(results.pack(tmp_path / "packed.zip"))
    assert packed.folder == tmp_path / "packed.zip"
    assert_frame_equal(packed.table(), results.table())
    assert_frame_equal(packed.reconstructions(), results.reconstructions())
    assert packed.settings == results.settings
    assert (packed.status().planned, packed.status().left) == (3, 1)


def test_every_stored_row_is_packed(results: Results, tmp_path: Path) -> None:
    with zipfile.ZipFile(results.pack(tmp_path / "packed.zip")) as archive:
        archive.extractall(tmp_path / "again")
    again = Store.open(tmp_path / "again")
    [part] = again.parts()
    keys = pl.read_parquet(part)["row_key"].to_list()
    here = Store(results.folder)
    assert sorted(keys) == sorted(here.rows()["row_key"])
    assert len(keys) == 5
    for timing in ("shared", "exclusive"):
        assert again.present(timing, retry_failed=True) == here.present(timing, retry_failed=True)
    assert_frame_equal(again.plan(), here.plan())


def test_an_unpacked_folder_goes_on(results: Results, tmp_path: Path) -> None:
    with zipfile.ZipFile(results.pack(tmp_path / "packed.zip")) as archive:
        archive.extractall(tmp_path / "again")
    store = Store.create(tmp_path / "again")
    with store.writing():
        store.write_rows("new", [row(3)])
    assert Results(store.folder).status().left == 0


def test_the_same_content_gives_the_same_file(results: Results, tmp_path: Path) -> None:
    first = results.pack(tmp_path / "first.zip").read_bytes()
    (tmp_path / "second.zip").write_text("older")
    assert Results(tmp_path / "first.zip").pack(tmp_path / "second.zip").read_bytes() == first


def test_what_was_unpacked_is_removed(results: Results, tmp_path: Path, temporary: Path) -> None:
    packed = Results(results.pack(tmp_path / "packed.zip"))
    assert len(list(temporary.iterdir())) == 1
    del packed
    gc.collect()
    assert list(temporary.iterdir()) == []


def test_a_file_zipped_by_hand_is_read(results: Results, tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "hand.zip", "w") as archive:
        for path in [results.folder, *results.folder.rglob("*")]:
            archive.write(path, Path("mine") / path.relative_to(results.folder))
        archive.writestr("mine/notes.txt", "read me")
    assert_frame_equal(Results(tmp_path / "hand.zip").table(), results.table())


def test_a_file_that_cannot_be_written_is_told(results: Results, tmp_path: Path) -> None:
    with pytest.raises(StoreError, match=r"packed\.zip"):
        results.pack(tmp_path / "missing" / "packed.zip")
    with pytest.raises(StoreError, match=str(results.folder)):
        results.pack(results.folder)
    assert len(results.table()) == 2


@pytest.mark.parametrize("name", ["../evil.parquet", "/etc/evil", "parts/../../evil.parquet"])
def test_nothing_lands_outside(
    results: Results, tmp_path: Path, temporary: Path, name: str
) -> None:
    file = results.pack(tmp_path / "packed.zip")
    with zipfile.ZipFile(file, "a") as archive:
        archive.writestr(name, "evil")
    with pytest.raises(StoreError, match="evil"):
        Results(file)
    assert list(temporary.iterdir()) == []


@pytest.mark.slow
def test_damage_is_told(results: Results, tmp_path: Path, temporary: Path) -> None:
    file = results.pack(tmp_path / "packed.zip")
    whole = file.read_bytes()
    middle = len(whole) // 3
    damaged = (
        b"",
        b"dataset,pair\n",
        whole[:middle],
        whole[:-40],
        whole[:middle] + bytes(200) + whole[middle + 200 :],
    )
    for content in damaged:
        file.write_bytes(content)
        with pytest.raises(StoreError, match=r"packed\.zip"):
            Results(file).table()
        gc.collect()
        assert list(temporary.iterdir()) == []


@pytest.mark.slow
def test_an_archive_that_becomes_gigabytes_is_not_unpacked(
    results: Results, tmp_path: Path, temporary: Path
) -> None:
    file = results.pack(tmp_path / "packed.zip")
    with (
        zipfile.ZipFile(file, "a", zipfile.ZIP_DEFLATED) as archive,
        archive.open("parts/more.parquet", "w") as member,
    ):
        for _ in range(600):
            member.write(bytes(2**20))
    with pytest.raises(StoreError, match=r"packed\.zip is not read.*would become 0\.6 GB"):
        Results(file)
    assert list(temporary.iterdir()) == []


@pytest.mark.slow
def test_a_table_that_becomes_gigabytes_is_not_read(
    results: Results, tmp_path: Path, temporary: Path
) -> None:
    rows = pl.DataFrame({"row_key": pl.repeat("x", 40_000_000, eager=True)})
    content = parquet_content(rows.with_columns(pl.lit(0.5).alias("precision")))
    assert len(content) < 400_000
    file = results.pack(tmp_path / "packed.zip")
    with zipfile.ZipFile(file, "a") as archive:
        archive.writestr("parts/more.parquet", content)
    with pytest.raises(StoreError, match=r"in parts/more\.parquet .*would become 1\.\d GB"):
        Results(file)
    assert list(temporary.iterdir()) == []


@pytest.mark.parametrize(
    ("names", "told"),
    [
        ((), "run.json"),
        (("a/b/run.json",), "run.json"),
        (("a/run.json", "b/run.json"), "run.json"),
        (("run.json",), "plan.parquet"),
    ],
)
def test_other_archives_are_refused(tmp_path: Path, names: tuple[str, ...], told: str) -> None:
    with zipfile.ZipFile(tmp_path / "other.zip", "w") as archive:
        for name in names:
            archive.writestr(name, "{}")
    with pytest.raises(StoreError, match=rf"other\.zip.*{told}"):
        Results(tmp_path / "other.zip")
