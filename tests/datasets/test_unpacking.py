"""Archives that become many times larger than they are, are not unpacked."""

from __future__ import annotations

import io
import tarfile
import zipfile
from pathlib import Path
from typing import Any

import pytest

from aerocues import expansion
from aerocues.datasets.unpacking import unpack_sequences
from aerocues.errors import DatasetError


@pytest.mark.parametrize("kind", ["zip", "tar.gz", "tar.xz"])
def test_a_bomb_is_not_unpacked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str) -> None:
    monkeypatch.setattr(expansion, "LARGEST_SMALL", 10**6)
    archive, zeros = tmp_path / f"graf.{kind}", bytes(800_000)
    names = ("graf/H1to2p", "graf/img1.ppm")
    if kind == "zip":
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as zipped:
            for name in names:
                zipped.writestr(name, zeros)
    else:
        how: Any = f"w:{kind.partition('.')[2]}"
        with tarfile.open(archive, how) as tar:
            for name in names:
                member = tarfile.TarInfo(name)
                member.size = len(zeros)
                tar.addfile(member, io.BytesIO(zeros))
    with pytest.raises(DatasetError, match=rf"graf\.{kind} is not unpacked: .* or more"):
        unpack_sequences(archive, tmp_path, "H1to2p", "graf")
    assert [path.name for path in tmp_path.iterdir()] == [archive.name]
    monkeypatch.setattr(expansion, "LARGEST_SMALL", 10**7)
    assert unpack_sequences(archive, tmp_path, "H1to2p", "graf") == ["graf"]
