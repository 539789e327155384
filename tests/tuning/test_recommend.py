"""From a folder of images to an answer: races, what cannot be raced, going on."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from aerocues.datasets.dataset import Pair
from aerocues.tuning.journal import recorded_answer
from aerocues.tuning.representative import spread_pairs
from tests.cli.conftest import Answer, Call
from tests.cli.other_machine import slower_copy
from tests.cli.test_interruption import PROGRAM
from tests.waiting import wait_until

SOME = "ORB-*-HAM-BF,AKAZE-AKAZE-*,GFTT-BRIEF-*,STAR-SIFT-*,!*-BOOST-*"
FEW = "ORB-ORB-HAM-BF,ORB-BRIEF-HAM-BF,AKAZE-AKAZE-HAM-BF"
# More than enough: these races end when all is measured, however slow the machine is.
ENOUGH = ("--budget", "1h", "--workers", 1, "--no-final")


def race(call: Call, photos: Path, output: Path, *more: object, names: str = SOME) -> Answer:
    return call("recommend", photos, "-o", output, "--combinations", names, *ENOUGH, *more)


@pytest.mark.slow
def test_the_answer_says_what_how_sure_why_and_what_next(
    call: Call, photos: Path, tmp_path: Path
) -> None:
    output, page = tmp_path / "race", tmp_path / "page.html"
    answer = race(call, photos, output, "--explain", "--report", page)
    assert answer.code == 0, answer.err
    best = re.search(r"^Take (\S+)\.$", answer.out, re.MULTILINE)
    assert best is not None
    assert re.search(r"^ *1 +" + re.escape(best[1]), answer.out, re.MULTILINE)
    assert re.search(r"best of 14 ", answer.out)
    assert re.search(r"^why +[\d,]+ \w+", answer.out, re.MULTILINE)
    assert re.search(r"^costs +.* 0\.\d\d s\b", answer.out, re.MULTILINE)
    assert re.search(r"^leader +seconds +measured ", answer.out, re.MULTILINE)
    # Exact search finds what brute force finds, in less time; which of them leads depends on both.
    exact = best[1].replace("-BF", "-EXACT")
    assert f"aerocues reconstruct {photos} -o models --combinations {exact}" in answer.out
    assert "pairs" in answer.err
    assert page.stat().st_size > 100_000
    told = recorded_answer(output)
    assert told is not None
    assert (told["best"], told["combinations"]) == (best[1], 14)

    # The same race once more: nothing is measured, and the answer is the same.
    parts = sorted((output / "parts").iterdir())
    again = race(call, photos, output, "--explain")
    assert sorted((output / "parts").iterdir()) == parts
    assert again.out == answer.out.replace(f"report   {page}\n", "")


@pytest.mark.slow
def test_objectives_and_devices_count(call: Call, photos: Path, tmp_path: Path) -> None:
    output = tmp_path / "race"
    for objective in ("speed", "accuracy", "reconstruction", "robust"):
        answer = race(call, photos, output, "--objective", objective, "--explain", names=FEW)
        assert answer.code == 0, answer.err
        assert answer.out.startswith(f"{objective}: ")
    board = slower_copy(output, tmp_path / "board")
    factors = tmp_path / "factors.json"
    compared = call("compare", output, board, "--factors", factors)
    assert compared.code == 0, compared.err
    there = race(call, photos, output, "--objective", "speed", "--device", factors, names=FEW)
    assert "slow board" in there.out
    third = slower_copy(board, tmp_path / "slower")
    refused = call("compare", output, board, third, "--factors", factors)
    assert refused.code == 2
    assert "--factors" in refused.err


def picture(path: Path, seed: int | None) -> None:
    pixels = np.full((180, 240, 3), 90, np.uint8)
    if seed is not None:
        random = np.random.default_rng(seed)
        for _ in range(150):
            y, x = random.integers(0, (170, 230))
            pixels[y : y + 12, x : x + 14] = random.integers(0, 256, 3)
    path.parent.mkdir(exist_ok=True)
    Image.fromarray(pixels).save(path)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seeds", "words"),
    [
        ([3], "two"),
        ([None, None, None], "blank"),
        ([1, 2, 3], "2 pairs"),
    ],
)
def test_images_that_allow_no_answer_get_none(
    call: Call, tmp_path: Path, seeds: list[int | None], words: str
) -> None:
    for number, seed in enumerate(seeds):
        picture(tmp_path / "images" / f"{number}.png", seed)
    answer = race(call, tmp_path / "images", tmp_path / "race")
    assert answer.code == 2
    assert answer.out == ""
    assert words in answer.err
    assert answer.err.count("error: ") == 1


@pytest.mark.slow
def test_a_preset_without_a_chance_test_guesses_no_more_than_others(
    call: Call, photos: Path, tmp_path: Path
) -> None:
    for number in range(3):
        picture(tmp_path / "images" / f"{number}.png", number + 1)
    answer = race(call, tmp_path / "images", tmp_path / "race", "--preset", "thesis")
    assert answer.code == 2
    assert "2 pairs" in answer.err

    output = tmp_path / "results"
    two = ("--combinations", "ORB-ORB-HAM-BF,AKAZE-AKAZE-HAM-BF")
    found = call("recommend", photos, "-o", output, "--preset", "thesis", *two, *ENOUGH)
    assert found.code == 0, found.err
    # The folder is about what was raced for, without what looked for overlap.
    rows = call("results", output, "--csv", tmp_path / "rows.csv")
    assert rows.code == 0, rows.err
    assert "FLANN" not in (tmp_path / "rows.csv").read_text()


def test_a_budget_that_is_too_small_is_told_at_once(
    call: Call, photos: Path, tmp_path: Path
) -> None:
    answer = call("recommend", photos, "-o", tmp_path / "race", "--budget", "0.3s")
    assert answer.code == 2
    assert re.search(
        r"^error: the budget is too small: .*--budget \d+(s|min)$", answer.err, re.MULTILINE
    )


@pytest.mark.slow
def test_other_parameters_are_another_race(call: Call, photos: Path, tmp_path: Path) -> None:
    preset, output = tmp_path / "mine.json", tmp_path / "race"
    two = ("--combinations", "ORB-ORB-HAM-BF,ORB-BRIEF-HAM-BF", *ENOUGH)
    for levels in (8, 4, 4):
        content = {"name": "mine", "title": "", "chance_test": True}
        preset.write_text(json.dumps({**content, "detectors": {"ORB": {"nlevels": levels}}}))
        answer = call("recommend", photos, "-o", output, "--preset", preset, *two)
        assert answer.code == 0, answer.err
    assert len(races_in(output / "race.json")) == 2


@pytest.mark.slow
def test_the_next_commands_have_the_options_and_suit_the_images(
    call: Call, photos: Path, tmp_path: Path
) -> None:
    two = ("--combinations", "ORB-ORB-HAM-BF,AKAZE-AKAZE-HAM-BF", *ENOUGH)
    options = ("--pairs", "consecutive:2", "--subset", "*.png", "--equalize", "clahe")
    same = "--pairs consecutive:2 --subset '*.png' --equalize clahe --max-keypoints {}--seed 7"
    answer = call(
        "recommend", photos, "-o", tmp_path / "a", *two, *options, "--seed", 7,
        "--max-keypoints", 900,
    )  # fmt: skip
    assert answer.code == 0, answer.err
    for command, footing in (("reconstruct", ""), ("run", " --equal-footing")):
        asked = f"{same.format('900 ')}{footing}"
        assert f" aerocues {command} {photos} {asked} -o" in answer.out
    assert f"-HAM-BF --from {tmp_path / 'a'} --as python" in answer.out

    flat = call(
        "recommend", f"synthetic:{photos}/0.png", "-o", tmp_path / "b", "--max-pairs", 2, *two
    )
    assert flat.code == 0, flat.err
    assert "reconstruct" not in flat.out
    asked = "--max-keypoints 8000 --equal-footing"
    assert f"aerocues run synthetic:{photos}/0.png {asked} -o" in flat.out


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--budget", "soon"), "--budget must be a time"),
        (("--budget", "0s"), "got '0s'"),
        (("--combinations", "ORB-ORB-HAM-BF"), "two"),
        (("--objective", "best"), "--objective"),
        (("--sure", "0.1"), "--sure"),
        (("--device", "missing.json"), "missing.json"),
    ],
)
def test_mistakes_are_told(
    call: Call, photos: Path, tmp_path: Path, words: tuple[str, ...], told: str
) -> None:
    answer = call("recommend", photos, "-o", tmp_path / "r", *words)
    assert answer.code == 2
    assert told in answer.err


def test_pairs_are_spread_over_sequences_by_their_share() -> None:
    pairs = [Pair(i, f"{i}a", f"{i}b", "long" if i < 40 else "short") for i in range(50)]
    chosen = spread_pairs(pairs, 10)
    assert [pair.sequence for pair in chosen] == ["long"] * 8 + ["short"] * 2
    gaps = np.diff([pair.index for pair in chosen[:8]])
    assert gaps.min() >= 4
    assert spread_pairs(pairs, 50) == pairs
    assert len({pair.sequence for pair in spread_pairs(pairs, 2)}) == 2


@given(st.lists(st.integers(1, 9), min_size=1, max_size=130), st.integers(2, 30), st.integers(0, 9))
def test_no_more_pairs_than_asked_for(sizes: list[int], most: int, seed: int) -> None:
    sequences = [f"{number}" for number, size in enumerate(sizes) for _ in range(size)]
    pairs = [Pair(i, f"{i}a", f"{i}b", name) for i, name in enumerate(sequences)]
    chosen = spread_pairs(pairs, most, seed)
    numbers = [pair.index for pair in chosen]
    assert len(numbers) == len(set(numbers)) == min(most, len(pairs))
    assert numbers == sorted(numbers)
    assert len({pair.sequence for pair in chosen}) == min(most, len(sizes))
    assert spread_pairs(pairs, most, seed) == chosen


def test_sequences_that_stand_for_others_are_spread() -> None:
    pairs = [Pair(i, f"{i}a", f"{i}b", f"{i // 5}") for i in range(580)]
    chosen = [int(pair.sequence) for pair in spread_pairs(pairs, 24)]
    assert max(np.diff(chosen)) < 10
    assert [int(pair.sequence) for pair in spread_pairs(pairs, 24, seed=1)] != chosen


def races_in(journal: Path) -> list[dict[str, Any]]:
    """The races that a file holds, beside the answer of the latest."""
    return [each for each in json.loads(journal.read_text()).values() if "steps" in each]


def steps_of(journal: Path) -> list[dict[str, object]]:
    if not journal.exists():
        return []
    [race] = races_in(journal)
    steps: list[dict[str, object]] = race["steps"]
    return steps


@pytest.mark.slow
def test_an_interrupted_race_goes_on_as_it_began(photos: Path, tmp_path: Path) -> None:
    output = tmp_path / "race"
    words = ["recommend", str(photos), "-o", str(output), *map(str, ENOUGH)]
    words += ["--combinations", "ORB-*-HAM-BF,*-BRIEF-HAM-BF,!*-BOOST-*,!HL-*,!MSD-*,!TBMR-*"]
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *words], stderr=subprocess.PIPE, text=True
    )
    journal = output / "race.json"
    wait_until(lambda: process.poll() is not None or len(steps_of(journal)) >= 2)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate()
    assert process.returncode == 130, err
    assert err.splitlines()[-1].startswith("interrupted; ")
    begun = steps_of(journal)

    def again() -> str:
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM, *words], capture_output=True, text=True, check=True
        )
        return done.stdout

    answer = again()
    finished = steps_of(journal)
    assert finished[: len(begun)] == begun
    assert len(finished) > len(begun)
    # What the first part took counts.
    assert begun[-1]["spent"] < finished[-1]["spent"]  # type: ignore[operator]
    assert answer == again()
