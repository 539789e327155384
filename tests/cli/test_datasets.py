from __future__ import annotations

import json
from pathlib import Path

from typer.testing import CliRunner

from aerocues.cli.datasets import app

runner = CliRunner()


def test_the_list_names_every_kind_and_where_it_is() -> None:
    result = runner.invoke(app, [])
    assert result.exit_code == 0
    for word in ("synthetic[:IMAGE]", "oxford:DIR", "hpatches:DIR", "uav:DIR", "flight:DIR"):
        assert word in result.output
    assert "aerocues datasets fetch oxford --to DIR" in result.output


def test_json() -> None:
    result = runner.invoke(app, ["--json"])
    rows = {row["name"]: row for row in json.loads(result.output)}
    assert rows["oxford"]["ground_truth"] == "homographies"
    assert rows["flight"]["takes_pairs"] is True
    assert "layout" in rows["hpatches"]


def test_errors_are_one_line_and_exit_with_2(tmp_path: Path) -> None:
    for arguments in (
        ["fetch", "aerial", "--to", str(tmp_path)],
        ["fetch", "oxford", "--to", str(tmp_path), "--base-url", "nowhere"],
    ):
        result = runner.invoke(app, arguments)
        assert result.exit_code == 2
        assert result.stderr.startswith("error: ")
        assert result.stderr.count("\n") == 1


def test_fetch_tells_how_to_go_on(tmp_path: Path) -> None:
    sequences = ("bark", "bikes", "boat", "graf", "leuven", "trees", "ubc", "wall")
    for name in sequences:
        (tmp_path / name).mkdir()
    record = {"sha256": {}, "sequences": {name: [name] for name in sequences}}
    (tmp_path / "checksums.json").write_text(json.dumps(record))
    result = runner.invoke(app, ["fetch", "oxford", "--to", str(tmp_path)])
    assert result.exit_code == 0
    assert f"aerocues run oxford:{tmp_path}" in result.output.replace("\n", "")
