"""Pictures show what was measured, or say why they do not."""

from __future__ import annotations

import base64
import io
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from PIL import Image

import aerocues
from aerocues import Results
from aerocues.report import pictures
from aerocues.report.choice import chosen_combinations, chosen_pictures
from aerocues.report.drawing_process import DrawingProcess
from aerocues.report.drawn_matches import DrawnMatches
from aerocues.report.entry import ReportEntry
from aerocues.report.pictures import Pictures, pictures_of
from aerocues.report.report import report_entries, write_report
from aerocues.report.size import fitting
from tests.report.decoding import floats, numbers, payload_in


@pytest.fixture(scope="module")
def entry(finished: Results) -> ReportEntry:
    return report_entries([finished], resamples=50)[0]


@pytest.fixture(scope="module")
def drawn(entry: ReportEntry) -> Pictures:
    return pictures_of(entry, 2)


@pytest.mark.slow
def test_the_same_is_found_again(drawn: Pictures, entry: ReportEntry) -> None:
    assert drawn.notes == []
    assert len(drawn.pictures) >= 4
    for picture in drawn.pictures:
        figures = picture["figures"]
        assert picture["note"] is None
        every = picture["matches_every"]
        matches = -(-figures["matches"] // every)
        assert floats(picture["matches"], matches, 4).shape == (matches, 4)
        inlier = numbers(picture["inlier"], matches)
        if every == 1:
            assert inlier.sum() == figures["inliers"]
        keypoints = -(-figures["keypoints_1"] // picture["keypoints_every"])
        assert floats(picture["keypoints_1"], keypoints, 2).max() < 240


def test_images_are_small_and_to_scale(drawn: Pictures) -> None:
    used = {picture[side] for picture in drawn.pictures for side in ("image_1", "image_2")}
    assert used == drawn.images.keys()
    for image in drawn.images.values():
        content = base64.b64decode(image["src"].removeprefix("data:image/webp;base64,"))
        with Image.open(io.BytesIO(content)) as decoded:
            assert decoded.size == (image["width"], image["height"]) == (240, 180)
        assert image["scale"] == 1


def test_the_best_comes_first_and_the_same_pairs_for_all(entry: ReportEntry) -> None:
    best = entry.combinations[entry.ranking.scores.best]
    choices = chosen_pictures(entry, 3)
    assert choices[0].combination == best
    shared = [choice.pair for choice in choices if choice.combination == best]
    for name in chosen_combinations(entry, 3):
        assert {each.pair for each in choices if each.combination == name} >= set(shared)
    assert len(set(choices)) == len(choices)
    assert chosen_pictures(entry, 0) == []


def test_another_detector_is_among_them(entry: ReportEntry) -> None:
    names = list(chosen_combinations(entry, 2))
    assert names[0].split("-")[0] != names[1].split("-")[0]


@pytest.mark.slow
def test_pictures_of_images_that_moved(
    photos: Path, tmp_path: Path, finished: Results, entry: ReportEntry
) -> None:
    moved = tmp_path / "elsewhere"
    shutil.copytree(photos, moved)
    page = write_report(
        finished, tmp_path / "page.html", images=[str(moved)], pictures=1, resamples=50
    )
    payload = payload_in(page)
    assert payload["pictures"]
    assert str(photos) not in page.read_text(encoding="utf-8")


@pytest.fixture
def own(photos: Path, tmp_path: Path) -> Results:
    """A run on images that a test may spoil."""
    shutil.copytree(photos, tmp_path / "photos")
    return aerocues.run(
        aerocues.open_dataset(str(tmp_path / "photos"), max_pairs=1),
        "ORB-ORB-HAM-BF",
        tmp_path / "results",
        workers=1,
    )


def test_images_that_are_gone(own: Results, tmp_path: Path) -> None:
    shutil.rmtree(tmp_path / "photos")
    payload = payload_in(aerocues.write_report(own, tmp_path / "page.html", resamples=50))
    assert payload["pictures"] == []
    assert "no pictures" in payload["method"]["notes"][-1]


@pytest.mark.slow
def test_images_that_differ(own: Results, tmp_path: Path) -> None:
    for file in (tmp_path / "photos").iterdir():
        pixels = np.random.default_rng(0).integers(0, 255, (180, 240, 3), np.uint8)
        Image.fromarray(pixels).save(file)
    payload = payload_in(aerocues.write_report(own, tmp_path / "page.html", resamples=50))
    assert payload["pictures"] == []
    assert "the images, the version of OpenCV" in payload["method"]["notes"][-1]


def test_results_that_were_imported(flight: Results) -> None:
    [entry] = report_entries([flight], resamples=50)
    found = pictures_of(entry, 2)
    assert found.pictures == []
    assert "imported" in found.notes[0]


def test_other_counts_of_matches_are_told(entry: ReportEntry) -> None:
    points = np.zeros((5, 2), np.float32)
    found = DrawnMatches(points, points, np.zeros((4, 4), np.float32), np.ones(4, bool), True)
    row: dict[str, Any] = {"keypoints_1": 5, "keypoints_2": 5, "matches": 4, "inliers": 4}
    assert pictures._difference(row, found) is None
    told = pictures._difference({**row, "inliers": 3}, found)
    assert told is not None
    assert "3 inliers when measured, 4 here" in told


def drawing_processes() -> list[psutil.Process]:
    """Those that this process has started and that still run."""
    found = psutil.Process().children()
    return [each for each in found if "aerocues.report.drawing" in each.cmdline()]


def test_a_process_that_dies_costs_one_picture(entry: ReportEntry) -> None:
    from aerocues.methods.combination import Combination
    from aerocues.report.reopening import context_of

    orb = Combination.parse("ORB-ORB-HAM-BF")
    with DrawingProcess(context_of(entry)) as process:
        assert isinstance(process.draw(0, orb, 60), DrawnMatches)
        [child] = drawing_processes()
        child.kill()
        child.wait(10)
        assert process.draw(0, orb, 60) == "the process died while drawing it"
        assert isinstance(process.draw(0, orb, 60), DrawnMatches)


def test_a_process_that_takes_too_long_is_ended(entry: ReportEntry) -> None:
    from aerocues.methods.combination import Combination
    from aerocues.report.reopening import context_of

    with DrawingProcess(context_of(entry)) as process:
        told = process.draw(0, Combination.parse("ORB-ORB-HAM-BF"), 0.0)
        assert told == "it took more than 0 s"
        assert drawing_processes() == []


def some(number: int, size: int) -> Pictures:
    """Pictures of two images of their own each."""
    found = Pictures()
    for position in range(number):
        keys = [f"{size}-{position}-{side}" for side in (1, 2)]
        found.images |= {key: {"src": "x" * size} for key in keys}
        found.pictures.append({"image_1": keys[0], "image_2": keys[1], "why": str(position)})
    return found


def test_pictures_give_way_to_size() -> None:
    both = [some(3, 1000), some(3, 1001)]
    everything = fitting(both, 10**6)
    assert len(everything.pictures) == 6
    assert everything.notes == []
    few = fitting(both, 6500)
    assert [picture["why"] for picture in few.pictures] == ["0", "0"]
    assert few.images.keys() == {"1000-0-1", "1000-0-2", "1001-0-1", "1001-0-2"}
    assert few.notes == ["4 of 6 pictures are left out to keep the page small"]
    assert fitting(both, 0).pictures == []


@pytest.mark.slow
def test_the_page_stays_below_the_limit(finished: Results, tmp_path: Path) -> None:
    whole = aerocues.write_report(finished, tmp_path / "whole.html", resamples=50)
    limit = whole.stat().st_size / 1e6 - 0.02
    smaller = aerocues.write_report(
        finished, tmp_path / "small.html", resamples=50, max_megabytes=limit
    )
    assert smaller.stat().st_size <= limit * 1e6
    assert 0 < len(payload_in(smaller)["pictures"]) < len(payload_in(whole)["pictures"])
