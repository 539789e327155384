"""Damaged, foreign and hostile files in a results folder: told, contained and measured again."""

from __future__ import annotations

import contextlib
import io
import json
import os
import random
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import polars as pl
import pytest
from polars.testing import assert_frame_equal

from aerocues.errors import AerocuesError, DamageWarning, StoreError
from aerocues.results.checksums import agrees_with_checksum
from aerocues.results.expanded_size import expanded_size
from aerocues.results.measured_results import Results
from aerocues.results.store import Store
from aerocues.results.whole_files import parquet_content
from tests.results.test_store import planned, row


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Three parts with two rows each, and a table of models."""
    store = Store.create(tmp_path / "results")
    rows = [row(number, matches=100 + number, precision=number / 7) for number in range(1, 7)]
    store.write_plan(planned(rows))
    store.write_run({"settings_key": "now", "versions": {"opencv": "5.0"}, "exclusions": []})
    for name, first in (("a", 0), ("b", 2), ("c", 4)):
        store.write_rows(name, rows[first : first + 2])
    model = {name: row(1)[name] for name in ("dataset", "detector", "descriptor")}
    store.write_reconstructions(pl.DataFrame([{**model, "points_3d": 77}]))
    return store.folder


def part(folder: Path, name: str = "b") -> Path:
    return folder / "parts" / f"{name}.parquet"


def flipped(content: bytes, bit: int) -> bytes:
    changed = bytearray(content)
    changed[bit // 8] ^= 1 << bit % 8
    return bytes(changed)


def without_checksum(file: Path) -> bytes:
    """The content as older versions wrote it."""
    table = pl.read_parquet(file)
    table.write_parquet(file, compression="zstd")
    return file.read_bytes()


def test_tables_carry_a_checksum_and_are_parquet_all_the_same() -> None:
    table = pl.DataFrame({"a": [1, 2, 3], "b": ["x", None, "z"]})
    content = parquet_content(table)
    assert agrees_with_checksum(io.BytesIO(content)) is True
    assert_frame_equal(pl.read_parquet(content), table)
    for other in (content[:-1], content + b"x", content[1:], flipped(content, 100)):
        assert agrees_with_checksum(io.BytesIO(other)) is False
    assert agrees_with_checksum(io.BytesIO(b"PAR1 of others PAR1")) is None


DAMAGE: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda content: b"",
    "cut": lambda content: content[: len(content) // 2],
    "without its end": lambda content: content[:-1],
    "zeros": lambda content: bytes(len(content)),
    "other text": lambda content: b"no parquet at all",
    "a mark only": lambda content: b"PAR1" + b"x" * 200 + b"PAR1",
    "one bit": lambda content: flipped(content, 4000),
}


@pytest.mark.parametrize("how", DAMAGE)
@pytest.mark.parametrize("old", [False, True])
def test_a_damaged_part_costs_its_own_rows_and_is_measured_again(
    folder: Path, how: str, old: bool
) -> None:
    if old and how == "one bit":
        pytest.skip("without a checksum nobody can tell")
    whole = Results(folder).table()
    content = without_checksum(part(folder)) if old else part(folder).read_bytes()
    part(folder).write_bytes(DAMAGE[how](content))
    store = Store.open(folder)
    with pytest.warns(DamageWarning, match=r"b\.parquet.*left out"):
        assert_frame_equal(store.table(), whole.filter(~pl.col("pair").is_in([3, 4])))
    with pytest.warns(DamageWarning, match=r"b\.parquet"):
        assert len(store.present("shared", retry_failed=False)) == 4
    again = Store.create(folder)
    with contextlib.ExitStack() as writing:
        with pytest.warns(DamageWarning, match="measured again"):
            writing.enter_context(again.writing())
        assert [file.name for file in again.parts()] == ["a.parquet", "c.parquet"]
        again.write_rows("b", whole.filter(pl.col("pair").is_in([3, 4])).to_dicts())
    assert_frame_equal(Store.open(folder).table(), whole)
    assert (folder / "damaged" / "b.parquet").read_bytes() == DAMAGE[how](content)


def test_a_damaged_plan_is_made_good_by_the_measured_rows_and_the_next_run(folder: Path) -> None:
    whole = Results(folder).table()
    plan = folder / "plan.parquet"
    plan.write_bytes(flipped(plan.read_bytes(), 999))
    with pytest.warns(DamageWarning, match=r"plan\.parquet"):
        assert_frame_equal(Results(folder).table(), whole)
    store = Store.create(folder)
    with contextlib.ExitStack() as writing:
        with pytest.warns(DamageWarning, match=r"plan\.parquet.*moved"):
            writing.enter_context(store.writing())
        store.write_plan(planned([row(number) for number in range(1, 7)]))
    assert_frame_equal(Results(folder).table(), whole)


def test_damaged_models_are_left_out(folder: Path) -> None:
    file = folder / "reconstructions.parquet"
    file.write_bytes(file.read_bytes()[:-3])
    with pytest.warns(DamageWarning, match="reconstruct"):
        assert Results(folder).reconstructions().is_empty()
    with pytest.warns(DamageWarning), Store.create(folder).writing():
        pass
    assert (folder / "damaged" / "reconstructions.parquet").exists()


def test_hidden_and_foreign_files_are_ignored(folder: Path) -> None:
    whole = Results(folder).table()
    part(folder, "._a").write_bytes(b"\0\5\26\7")
    (folder / ".DS_Store").write_bytes(b"x")
    os.mkfifo(part(folder, "pipe"))
    part(folder, "folder").mkdir()
    part(folder, "link").symlink_to("nowhere.parquet")
    (folder / "parts" / "notes.txt").write_text("mine")
    assert_frame_equal(Results(folder).table(), whole)
    with Store.create(folder).writing():
        assert len(Store.open(folder).parts()) == 3
    new = folder.parent / "new"
    new.mkdir()
    (new / ".DS_Store").write_bytes(b"x")
    Store.create(new)


def test_a_file_without_access_is_no_damage(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    opened = Path.open

    def refused(path: Path, *how: Any, **more: Any) -> Any:
        if path.name == "b.parquet":
            raise PermissionError(13, "Permission denied", str(path))
        return opened(path, *how, **more)

    monkeypatch.setattr(Path, "open", refused)
    for reading in (Store.open(folder).table, Store.create(folder).writing().__enter__):
        with pytest.raises(StoreError, match=r"b\.parquet: Permission denied; grant access"):
            reading()
    assert part(folder).exists()


def test_every_file_is_checked(folder: Path) -> None:
    assert [each.problem for each in Results(folder).verify()] == [None] * 6
    without_checksum(part(folder, "a"))
    part(folder, "c").write_bytes(b"")
    checked = {each.file.name: each for each in Results(folder).verify()}
    assert not checked["a.parquet"].has_checksum
    assert checked["c.parquet"].problem == "it is empty"
    (folder / "run.json").write_text("{}")
    (folder / "plan.parquet").write_bytes(b"x")
    problems = [each.file.name for each in Results(folder).verify() if each.problem]
    assert problems == ["plan.parquet", "c.parquet"]


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"exclusions": {}}, "exclusions must be a list"),
        ({"exclusions": [{"combination": "A", "reason": "b"}]}, "pairs is missing"),
        ({"exclusions": [1]}, "an entry of exclusions must be an object"),
        ({"dataset": []}, "dataset must be an object"),
        ({"dataset": {"name": 7}}, r"dataset\.name must not be 7"),
        ({"settings_key": True}, "settings_key must not be true"),
        ({"versions": "5.0"}, "versions must not be"),
        ({"combinations": "ORB"}, "combinations must be a list"),
        ({"machine": None}, "machine must not be null"),
    ],
)
def test_a_record_of_another_form_is_refused(
    folder: Path, change: dict[str, Any], told: str
) -> None:
    facts = json.loads((folder / "run.json").read_text())
    (folder / "run.json").write_text(json.dumps({**facts, **change}))
    with pytest.raises(StoreError, match=rf"run\.json is damaged: .*{told}"):
        Results(folder).status()


def test_a_record_that_is_nested_without_end_is_refused(folder: Path) -> None:
    (folder / "run.json").write_text("[" * 100_000)
    with pytest.raises(StoreError, match=r"run\.json.*nested too deeply"):
        Results(folder).table()


def test_a_changed_record_is_told(folder: Path) -> None:
    facts = json.loads((folder / "run.json").read_text())
    (folder / "run.json").write_text(json.dumps({**facts, "versions": {"opencv": "4.0"}}))
    with pytest.warns(DamageWarning, match=r"run\.json.*changed after it was written"):
        assert Results(folder).settings["versions"] == {"opencv": "4.0"}


def test_what_a_few_bytes_become_is_known_before_they_are_read(folder: Path) -> None:
    rows = pl.DataFrame({"row_key": pl.repeat("x", 10**7, eager=True)})
    assert expanded_size(parquet_content(rows)) > 10**8
    long = parquet_content(pl.DataFrame({"row_key": ["x" * 10**6]}))
    assert len(long) < 10**4
    assert expanded_size(long) > 10**6


@pytest.mark.parametrize("file", ["run.json", "plan.parquet", "reconstructions.parquet", "b"])
def test_no_flipped_bit_changes_a_value_silently(folder: Path, file: str) -> None:
    check_flips(folder, file, 25)


@pytest.mark.slow
@pytest.mark.parametrize("file", ["run.json", "plan.parquet", "reconstructions.parquet", "b"])
def test_no_flipped_bit_of_many_changes_a_value_silently(folder: Path, file: str) -> None:
    check_flips(folder, file, 150)


def check_flips(folder: Path, name: str, count: int) -> None:
    """Flip single bits of a file, one after the other; each is told, or changes nothing."""

    def answers() -> tuple[pl.DataFrame, pl.DataFrame, dict[str, Any]]:
        results = Results(folder)
        return results.table(), results.reconstructions(), results.settings

    file = part(folder) if name == "b" else folder / name
    content, sound = file.read_bytes(), answers()
    generator = random.Random(name)
    for _ in range(count):
        bit = generator.randrange(len(content) * 8)
        file.write_bytes(flipped(content, bit))
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            try:
                got = answers()
            except AerocuesError:
                continue
        if not told:
            assert_frame_equal(got[0], sound[0])
            assert_frame_equal(got[1], sound[1])
            # The name of the checksum may have changed: then the record is like an older one.
            assert {name: got[2].get(name) for name in sound[2]} == sound[2], bit
