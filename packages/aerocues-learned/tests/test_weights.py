"""Weights are those that were exported, and what is missing is told."""

from __future__ import annotations

from pathlib import Path

import pytest
from aerocues_learned.matchers import LightGlue
from aerocues_learned.sessions import Network
from aerocues_learned.weights import (
    FOLDER,
    LIGHTGLUE,
    VARIABLE,
    checksums,
    lightglue_weights,
    sha256,
)

from aerocues.errors import MethodUnavailableError


def test_files_are_those_that_were_exported() -> None:
    found = {file.name: sha256(file) for file in FOLDER.glob("*.onnx")}
    expected = dict(checksums())
    assert found.keys() | {LIGHTGLUE} == expected.keys()
    assert found.items() <= expected.items()


def test_weights_tell_nothing_of_the_machine_that_wrote_them() -> None:
    for file in FOLDER.glob("*.onnx"):
        assert b".py" not in file.read_bytes()


def test_missing_weights_are_told_with_what_to_do(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "none.onnx"))
    with pytest.raises(MethodUnavailableError, match=r"none\.onnx.*make learned-weights"):
        LightGlue(**LightGlue.parameters)


def test_other_weights_are_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    file = tmp_path / LIGHTGLUE
    file.write_bytes(b"something else")
    monkeypatch.setenv(VARIABLE, str(file))
    with pytest.raises(MethodUnavailableError, match="another file"):
        lightglue_weights()


def test_a_provider_that_is_not_there_is_told() -> None:
    with pytest.raises(MethodUnavailableError, match="NoneExecutionProvider"):
        Network(FOLDER / "xfeat.onnx", "NoneExecutionProvider")
