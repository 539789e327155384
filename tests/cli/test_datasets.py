from __future__ import annotations

import json
from pathlib import Path

import pytest

from aerocues.cli.program import exit_code


def test_the_list_names_every_kind_and_where_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code(["datasets"]) == 0
    output = capsys.readouterr().out
    for word in ("synthetic[:IMAGE]", "oxford:DIR", "hpatches:DIR", "uav:DIR", "flight:DIR"):
        assert word in output
    assert "aerocues datasets fetch oxford --to DIR" in output


def test_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_code(["datasets", "--json"]) == 0
    rows = {row["name"]: row for row in json.loads(capsys.readouterr().out)}
    assert rows["oxford"]["ground_truth"] == "homographies"
    assert rows["flight"]["takes_pairs"] is True
    assert "layout" in rows["hpatches"]


@pytest.mark.parametrize(
    "arguments", [["aerial"], ["oxford", "--base-url", "nowhere"], ["oxford", "--base-url", ""]]
)
def test_errors_are_one_line_and_exit_with_2(
    arguments: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert exit_code(["datasets", "fetch", *arguments, "--to", str(tmp_path)]) == 2
    message = capsys.readouterr().err
    assert message.startswith("error: ")
    assert message.count("\n") == 1


def test_fetch_tells_how_to_go_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sequences = ("bark", "bikes", "boat", "graf", "leuven", "trees", "ubc", "wall")
    for name in sequences:
        (tmp_path / name).mkdir()
    record = {"sha256": {}, "sequences": {name: [name] for name in sequences}}
    (tmp_path / "checksums.json").write_text(json.dumps(record))
    assert exit_code(["datasets", "fetch", "oxford", "--to", str(tmp_path)]) == 0
    assert f"aerocues run oxford:{tmp_path}" in capsys.readouterr().out
