"""Mutated files of every kind that users bring: read, told in plain words, never more than that.

Anything but a result or an `AerocuesError` fails the test; a hang is ended by pytest's limit.
"""

from __future__ import annotations

import io
import json
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import polars as pl
import pytest
from PIL import Image as Pillow

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.homography_sequences import read_homography
from aerocues.datasets.pairing import PairsFile
from aerocues.errors import AerocuesError
from aerocues.methods.presets import preset_named
from aerocues.results.clouds import Cloud, read_cloud
from aerocues.results.importing import import_results
from aerocues.results.measured_results import Results
from aerocues.results.reconstructions import read_reconstructions
from aerocues.results.store import Store
from aerocues.simulation.camera import pinhole
from aerocues.simulation.planner import open_survey
from aerocues.tuning.device import as_device
from aerocues.tuning.grids import read_grid
from aerocues.tuning.journal import Journal
from tests.fuzzing.mutations import mutated
from tests.results.test_store import planned, row

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]


@dataclass(frozen=True)
class Kind:
    """A kind of file: its name in a folder, a sound content, how it is read, and how often."""

    name: str
    content: Callable[[Path], bytes]
    read: Callable[[Path], object]
    count: int = 60


def store_file(name: str) -> Callable[[Path], bytes]:
    """The content of a file of a small results folder, which is made in the place."""

    def content(place: Path) -> bytes:
        store = Store.create(place)
        rows = [row(number, matches=100 + number, message="größe") for number in range(1, 5)]
        store.write_plan(planned(rows))
        store.write_run(
            {
                "settings_key": "now",
                "dataset": {"name": "d", "images": 5, "pairs": 4, "settings": {}, "source": None},
                "exclusions": [{"combination": "ORB-LUCID-HAM-BF", "reason": "gray", "pairs": 3}],
                "versions": {"opencv": "5.0"},
                "machine": {"name": "board"},
            }
        )
        store.write_rows("part", rows)
        model = {name: row(1)[name] for name in ("dataset", "detector", "descriptor")}
        store.write_reconstructions(pl.DataFrame([{**model, "points_3d": 77}]))
        return (place / name).read_bytes()

    return content


def without_checksum(place: Path) -> bytes:
    """A part as older versions wrote it."""
    store_file("parts/part.parquet")(place)
    file = io.BytesIO()
    pl.read_parquet(place / "parts" / "part.parquet").write_parquet(file, compression="zstd")
    return file.getvalue()


def read_folder(file: Path) -> None:
    folder = file.parent if (file.parent / "parts").is_dir() else file.parent.parent
    results = Results(folder)
    results.status()
    results.reconstructions()
    repr(results)
    results.verify()


def cloud(place: Path) -> bytes:
    points = np.zeros((4, 3), np.float32)
    return Cloud(
        points=points,
        colours=np.zeros((4, 3), np.uint8),
        errors=points[:, 0],
        track_lengths=np.full(4, 3, np.int32),
        distances=points[:, 0],
        centres=points[:2],
        rotations=np.zeros((2, 3, 3), np.float32),
        names=np.array(["a", "b"]),
        positions=points[:2],
        view=points[0],
        unit="m",
    ).content()


def packed(place: Path) -> bytes:
    store_file("run.json")(place / "folder")
    return Results(place / "folder").pack(place / "other.zip").read_bytes()


def image(form: str, **how: object) -> Callable[[Path], bytes]:
    def content(place: Path) -> bytes:
        pixels = np.random.default_rng(0).integers(0, 255, (40, 60, 3), np.uint8)
        exif = Pillow.Exif()
        exif[0x0112], exif[0x010F] = 6, "Maker"
        exif.get_ifd(0x8825).update({1: "N", 2: (47.0, 30.0, 1.5), 3: "E", 4: (8.0, 1.0, 2.0)})
        exif.get_ifd(0x8769).update({0x920A: 8.8, 0xA405: 24})
        file = io.BytesIO()
        Pillow.fromarray(pixels).save(file, form, exif=exif, **how)
        return file.getvalue()

    return content


def read_image(file: Path) -> None:
    """Read the whole of an image, as a dataset and a reconstruction do."""
    other = file.with_name("0.png")
    if not other.exists():
        Pillow.new("RGB", (60, 40)).save(other)
    [image] = [one for one in open_dataset(str(file.parent)).images if one.name == file.name]
    source: Any = image.source
    told: AerocuesError | None = None
    for look in (source.size, source.read, source.content_key, lambda: image.gps):
        try:
            look()
        except AerocuesError as error:
            told = error
    if told is not None:
        raise told


def table(rows: int) -> str:
    heading = (
        "dataset,platform,detector,descriptor,norm,matcher,pair,precision,recall,repeatability,"
        "f1_score,inliers,matches,seconds_per_1k_matches,seconds_per_1k_inliers"
    )
    lines = [f'q,"b, c",orb,orb,ham,bf,{n},0.6,0.2,0.2,0.3,610,1000,0.1,0.1' for n in range(rows)]
    return "\n".join((heading, *lines)) + "\n"


PRESET = {
    "name": "mine",
    "title": "of my own",
    "chance_test": True,
    "detectors": {"ORB": {"nlevels": 8, "scaleFactor": 1.2}},
    "on_detectors": {"ORB-BEBLID": {"scale_factor": 1.0}},
    "thresholds": {"ORB-ORB": 1.5},
}
MISSION = {"pattern": "orbit", "north": 90, "east": 80, "gsd": 2.5, "front": 0.8, "side": 0.6}
FACTORS = {
    "stages": {stage: {"*": 4.5} for stage in ("detect", "describe", "match", "verify")},
    "machine": "pi",
}
STEP = {"asked": "abc", "spent": 1.5, "kept": 0.5, "missing": ["key-1", "key-2"]}
RACE = {"key": {"budget": 60.0, "begun": 2.0, "given": ["a"], "steps": [STEP, STEP]}}


def read_pairs(file: Path) -> None:
    images: Any = [SimpleNamespace(name=name) for name in ("a.jpg", "b.jpg", "b c.jpg")]
    PairsFile(file).pairs(images)


def read_mission(file: Path) -> None:
    open_survey(str(file), pinhole(600, 400, 90.0))


def replay(file: Path) -> None:
    journal = Journal.read(file.parent, "key", 90.0)
    while journal.replay(["key-1"], {"key-1"}):
        pass
    journal.add(["key-1"], journal.spent + 1.0, 0.0, [])


def import_table(file: Path) -> None:
    for results in import_results(file, file.parent / "out" / str(abs(hash(file.read_bytes())))):
        results.table()


def text(value: object) -> Callable[[Path], bytes]:
    content = value if isinstance(value, str) else json.dumps(value, indent=1)
    return lambda place: content.encode()


KINDS = {
    "record": Kind("run.json", store_file("run.json"), read_folder),
    "plan": Kind("plan.parquet", store_file("plan.parquet"), read_folder),
    "models": Kind("reconstructions.parquet", store_file("reconstructions.parquet"), read_folder),
    "part": Kind("parts/part.parquet", store_file("parts/part.parquet"), read_folder),
    "older part": Kind("parts/part.parquet", without_checksum, read_folder, 120),
    "packed": Kind("packed.zip", packed, lambda file: Results(file).status()),
    "cloud": Kind("cloud.npz", cloud, lambda file: read_cloud(file.read_bytes(), file)),
    "preset": Kind("p.json", text(PRESET), lambda file: preset_named(str(file))),
    "grid": Kind("g.json", text({"nlevels": [4, 8], "patchSize": [31]}), read_grid),
    "factors": Kind("f.json", text(FACTORS), as_device),
    "mission": Kind("m.json", text(MISSION), read_mission),
    "journal": Kind("race.json", text(RACE), replay),
    "pairs": Kind("p.txt", text('a.jpg b.jpg # c\n"b c.jpg"\ta.jpg\n'), read_pairs),
    "homography": Kind("H", text("1.5e0, 0 0 # c\n0 2 0\n[1e-4 0 1]\n"), read_homography, 400),
    "table": Kind("t.csv", text(table(6)), import_table, 120),
    "models of others": Kind(
        "m.csv",
        text(
            "dataset,detector,descriptor,norm,matcher,reprojection_error,points_3d,"
            "reconstruction_seconds\nq,orb,orb,ham,bf,0.74,8106,12.1\n"
        ),
        read_reconstructions,
    ),
    "jpeg": Kind("1.jpg", image("JPEG", quality=80), read_image),
    "png": Kind("1.png", image("PNG"), read_image),
    "tiff": Kind("1.tif", image("TIFF", compression="tiff_lzw"), read_image),
}


@pytest.mark.parametrize("name", KINDS)
def test_a_mutated_file_is_read_or_told(
    name: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    kind = KINDS[name]
    content = kind.content(tmp_path)
    file = tmp_path / kind.name
    told = 0
    for changed in mutated(content, kind.count, name):
        file.write_bytes(changed)
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            try:
                kind.read(file)
            except AerocuesError:
                told += 1
            else:
                told += bool(warned)
    # A journal that is damaged is none: the race decides anew.
    assert told > kind.count / 20 or name == "journal"
    printed = capfd.readouterr().err
    assert "Traceback" not in printed
    assert "panicked" not in printed


def test_the_sound_files_are_read(tmp_path: Path) -> None:
    for name, kind in KINDS.items():
        place = tmp_path / name
        place.mkdir()
        content = kind.content(place)
        (place / kind.name).write_bytes(content)
        try:
            kind.read(place / kind.name)
        except AerocuesError as error:
            raise AssertionError(name) from error
