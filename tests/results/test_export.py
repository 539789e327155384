"""Tables as files: whole or not at all."""

from __future__ import annotations

from pathlib import Path

import polars as pl
import pytest

from aerocues.errors import StoreError
from aerocues.results.export import export_table

TABLE = pl.DataFrame({"name": ["a", "b"], "value": [1.5, None]})


def test_a_file_behind_a_link_is_replaced_and_the_link_stays(tmp_path: Path) -> None:
    file, link = tmp_path / "file.csv", tmp_path / "link.csv"
    file.write_text("older")
    link.symlink_to(file)
    export_table(TABLE, link, "csv")
    assert link.is_symlink()
    assert file.read_text() == "name,value\na,1.5\nb,\n"


def test_cells_that_look_like_formulas_are_defused_in_csv(tmp_path: Path) -> None:
    names = ["=cmd|'/c calc'!A1", "+1", "-1", "@SUM(A1)", "\t=1", "plain", "a=b", None]
    table = pl.DataFrame({"name": names, "value": [-1.5] * len(names)})
    export_table(table, tmp_path / "rows.csv", "csv")
    read = pl.read_csv(tmp_path / "rows.csv", infer_schema=False)
    assert read["name"].to_list() == [
        *(f"'{name}" for name in names[:5] if name),
        "plain",
        "a=b",
        None,
    ]
    assert read["value"].unique().to_list() == ["-1.5"]
    export_table(table, tmp_path / "rows.parquet", "parquet")
    assert pl.read_parquet(tmp_path / "rows.parquet")["name"].to_list() == names


def test_json_has_null_for_what_is_missing(tmp_path: Path) -> None:
    file = tmp_path / "rows.json"
    export_table(TABLE, file, "json")
    assert file.read_text() == '[{"name":"a","value":1.5},{"name":"b","value":null}]'


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_device_is_written_in_place_and_a_full_one_is_told() -> None:
    export_table(TABLE, Path("/dev/null"), "csv")
    with pytest.raises(StoreError, match=r"/dev/full.*No space left"):
        export_table(TABLE, Path("/dev/full"), "csv")
    assert Path("/dev/full").is_char_device()
