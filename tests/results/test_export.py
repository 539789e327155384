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
