"""Small images, a way to call the command line, and one finished run that tests read."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from aerocues.cli import main
from tests.made_once import made_once

COMBINATIONS = "ORB-ORB-HAM-BF,AKAZE-AKAZE-HAM-BF,GFTT-BRIEF-HAM-FLANN,ORB-FREAK-HAM-BF"
VIEWS = 4


@dataclass(frozen=True)
class Answer:
    """What a command printed and how it ended."""

    code: int
    out: str
    err: str


Call = Callable[..., Answer]


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Call:
    """Call the command line in this process."""
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.delenv("COLUMNS", raising=False)

    def run(*arguments: object) -> Answer:
        capsys.readouterr()
        with pytest.raises(SystemExit) as ending:
            main([str(argument) for argument in arguments])
        printed = capsys.readouterr()
        assert isinstance(ending.value.code, int)
        return Answer(ending.value.code, printed.out, printed.err)

    return run


def write_views(folder: Path) -> None:
    """Write 240 x 180 views of one textured picture, each moved and turned a little."""
    from PIL import Image

    generator = np.random.default_rng(0)
    picture = np.full((280, 340, 3), 110.0)
    for _ in range(260):
        y, x = generator.integers(0, (270, 330))
        height, width = generator.integers(4, 34, 2)
        picture[y : y + height, x : x + width] = generator.integers(20, 236, 3)
    folder.mkdir(parents=True)
    for number in range(VIEWS):
        noise = generator.normal(0, 2, picture.shape)
        pixels = np.clip(picture + noise, 0, 255).astype(np.uint8)
        turned = Image.fromarray(pixels).rotate(3 * number, Image.Resampling.BICUBIC)
        corner = 30 + 8 * number
        turned.crop((corner, corner, corner + 240, corner + 180)).save(folder / f"{number}.png")


def shared_views(factory: pytest.TempPathFactory) -> Path:
    """The folder of these views, for all tests that only read it."""

    def make(folder: Path) -> None:
        write_views(folder / "photos")

    return made_once(factory, "views", make)[0] / "photos"


@pytest.fixture(scope="session")
def photos(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of four overlapping images: three pairs."""
    return shared_views(tmp_path_factory)


@pytest.fixture(scope="session")
def finished(photos: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results folder of a finished run of 4 combinations on 3 pairs."""

    def make(folder: Path) -> None:
        words = ["run", str(photos), "-o", str(folder / "results"), "--combinations", COMBINATIONS]
        done = subprocess.run(
            [sys.executable, "-m", "aerocues", *words, "--workers", "1"],
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr

    return made_once(tmp_path_factory, "finished", make)[0] / "results"
