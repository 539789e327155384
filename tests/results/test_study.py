"""A study: parts as results, queries over all of them, and where it is found."""

from __future__ import annotations

import threading
import zipfile
from pathlib import Path

import pytest

import aerocues
from aerocues.errors import StoreError
from aerocues.results.importing import import_results
from aerocues.results.store import Store
from aerocues.results.study import add_part, without_places
from aerocues.results.study_dictionary import dictionary
from aerocues.results.study_place import study_folder
from tests.datasets.servers import Site, serve
from tests.evaluation.tables import figures, measured, write_table
from tests.made_once import made_once


@pytest.fixture(scope="module")
def database(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two parts: one with models, one without."""

    def make(folder: Path) -> None:
        table = write_table(folder / "rows.csv", measured("quarry", None, 4))
        models = write_table(folder / "models.csv", figures("quarry"))
        import_results(table, folder / "first", reconstruction=models)
        import_results(write_table(folder / "b.csv", measured("beach", None, 4)), folder / "second")
        for name in ("first", "second"):
            facts = {"title": f"the {name} part", "licence": "ours", "cpu_hours": 0.5}
            add_part(folder / "study" / "database", f"{name}-part", folder / name, facts)

    return made_once(tmp_path_factory, "study-of-two", make)[0] / "study" / "database"


def test_it_holds_the_rows_of_all_parts(database: Path) -> None:
    study = aerocues.Study(database)
    assert study.names == ("first-part", "second-part")
    assert study.table()["part"].value_counts(sort=True)["count"].to_list() == [8, 8]
    assert study.reconstructions()["part"].unique().to_list() == ["first-part"]
    parts = study.parts()
    assert parts["models"].to_list() == [2, 0]
    assert parts["title"].to_list() == ["the first part", "the second part"]
    assert "2 parts, 16 rows and 2 reconstructions" in repr(study)


def test_it_answers_queries_over_its_tables(database: Path) -> None:
    answer = aerocues.Study(database).sql(
        "SELECT parts.title, COUNT(*) AS failed FROM results JOIN parts ON results.part = "
        "parts.part WHERE status <> 'ok' GROUP BY parts.title ORDER BY parts.title"
    )
    assert answer.rows() == [("the first part", 1), ("the second part", 1)]
    with pytest.raises(StoreError, match="must begin with SELECT"):
        aerocues.Study(database).sql("DELETE FROM results")


def test_an_unknown_column_is_told_with_the_table_that_has_it(database: Path) -> None:
    with pytest.raises(StoreError, match="is in results, not in the table asked; 'aerocues study"):
        aerocues.Study(database).sql("SELECT total_seconds FROM reconstructions")
    with pytest.raises(StoreError, match="recal does not exist; did you mean recall"):
        aerocues.Study(database).sql("SELECT recal FROM results")


def test_each_column_of_its_tables_is_in_the_dictionary(database: Path) -> None:
    study, described = aerocues.Study(database), dictionary()
    tables = (study.parts(), study.table(), study.reconstructions())
    for table, columns in zip(tables, described.values(), strict=True):
        assert table.columns == [column.name for column in columns]
        assert all(column.definition for column in columns)


def test_a_part_is_opened_like_results(database: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("AEROCUES_STUDY", str(database))
    by_name = aerocues.score("study:first-part", resamples=10).frame("combination")
    again = aerocues.score(aerocues.Study().part("first-part"), resamples=10)
    assert by_name.equals(again.frame("combination"))
    assert aerocues.Results("study:first-part").folder == database / "first-part"
    with pytest.raises(StoreError, match="did you mean first-part"):
        aerocues.Results("study:frist-part")


def test_it_is_found_in_the_checkout(database: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("AEROCUES_STUDY", raising=False)
    inside = database.parent.parent / "inside"
    inside.mkdir(exist_ok=True)
    monkeypatch.chdir(inside)
    assert study_folder() == database


@pytest.mark.parametrize("place", [None, "nothing"])
def test_where_there_is_none_it_says_so(
    place: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("AEROCUES_STUDY", raising=False)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(StoreError):
        aerocues.Study(place)


def test_packed_it_can_be_opened_elsewhere(database: Path, tmp_path: Path) -> None:
    study = aerocues.Study(database)
    packed = study.pack(tmp_path / "study.zip")
    assert packed.read_bytes() == study.pack(tmp_path / "again.zip").read_bytes()
    opened = aerocues.Study(packed)
    assert opened.folder != database
    assert opened.table().equals(study.table())


def test_an_address_is_downloaded_once(database: Path, tmp_path: Path) -> None:
    packed = aerocues.Study(database).pack(tmp_path / "study.zip")
    site = Site({"study.zip": packed.read_bytes()})
    server = serve(site)
    threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True).start()
    try:
        address = f"http://127.0.0.1:{server.server_address[1]}/study.zip"
        assert len(aerocues.Study(address).table()) == 16
        assert aerocues.Study(address).names == ("first-part", "second-part")
    finally:
        server.shutdown()
        server.server_close()
    assert [name for name, _ in site.log] == ["study.zip"]


def test_what_would_become_too_large_is_not_opened(database: Path, tmp_path: Path) -> None:
    packed = aerocues.Study(database).pack(tmp_path / "study.zip")
    with zipfile.ZipFile(packed, "a") as archive:
        archive.writestr("first-part/parts/broken.parquet", b"PAR1 nothing PAR1")
    for _ in range(2):
        with pytest.raises(StoreError, match="not read"):
            aerocues.Study(packed)


def test_a_part_is_only_read(database: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("AEROCUES_STUDY", str(database))
    with pytest.raises(StoreError, match="only read"):
        Store.create(Path("study:first-part"))


def test_another_file_is_not_a_study(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("no archive")
    with pytest.raises(StoreError, match="not a packed study"):
        aerocues.Study(tmp_path / "notes.txt")


def test_names_of_parts_are_plain(database: Path, tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="cannot name a part"):
        add_part(tmp_path, "../outside", database / "first-part", {})


def test_places_of_a_machine_are_left_out() -> None:
    folder = Path(__file__).parent
    settings = {
        "preset": "tuned",
        "features": str(folder),
        "dataset": {
            "name": "photos",
            "source": {"spec": str(folder)},
            "settings": {"pairs": str(folder / "pairs.txt"), "max_width": "1000"},
        },
    }
    kept = {"name": "photos", "settings": {"pairs": "pairs.txt", "max_width": "1000"}}
    assert without_places(settings) == {"preset": "tuned", "dataset": kept}


def test_a_part_can_be_a_part_again(database: Path, tmp_path: Path) -> None:
    kept = add_part(tmp_path, "copy", database / "first-part", {})
    again = add_part(tmp_path, "copy", kept, {})
    assert aerocues.Results(again).table().equals(aerocues.Results(database / "first-part").table())
