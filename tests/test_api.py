"""The public interface from Python, as a notebook uses it."""

from __future__ import annotations

import importlib.metadata
import inspect
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import typer

import aerocues
from aerocues import AerocuesError, Combination, Event
from aerocues.arguments import seconds_of
from aerocues.cli.program import app
from aerocues.errors import ArgumentError
from tests.cli.conftest import shared_views
from tests.made_once import made_once

COMBINATIONS = "ORB-ORB-HAM-BF,ORB-BRIEF-HAM-BF,AKAZE-AKAZE-HAM-BF"
FUNCTIONS = sorted(
    name for name in aerocues.__all__ if inspect.isfunction(getattr(aerocues, name, None))
)
CLASSES = sorted(name for name in aerocues.__all__ if inspect.isclass(getattr(aerocues, name)))


@pytest.fixture(scope="module")
def photos(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of four overlapping images."""
    return shared_views(tmp_path_factory)


@pytest.fixture(scope="module")
def results(photos: Path, tmp_path_factory: pytest.TempPathFactory) -> aerocues.Results:
    """Three combinations on three pairs."""

    def make(folder: Path) -> None:
        aerocues.run(photos, COMBINATIONS, folder, timing="shared", workers=1)

    return aerocues.Results(made_once(tmp_path_factory, "results-of-three", make)[0])


def test_every_public_name_can_be_had() -> None:
    for name in aerocues.__all__:
        assert getattr(aerocues, name) is not None
    assert dir(aerocues) == sorted(aerocues.__all__)
    assert aerocues.__version__ == importlib.metadata.version("aerocues")
    assert set(aerocues._MODULES) == {*aerocues.__all__} - {"__version__"}


def test_other_names_cannot() -> None:
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        aerocues.nothing  # noqa: B018


@pytest.mark.parametrize("name", [*FUNCTIONS, *CLASSES])
def test_docstrings_name_parameters_results_and_errors(name: str) -> None:
    thing = getattr(aerocues, name)
    text = inspect.getdoc(thing) or ""
    assert text
    if issubclass(thing, Exception) if inspect.isclass(thing) else False:
        return
    signature = inspect.signature(thing)
    documented = {
        each.strip()
        for line in re.findall(r"^(\w[\w, ]*?)(?: : .*)?$", text, re.MULTILINE)
        for each in line.split(",")
    }
    parameters = [each for each in signature.parameters if not each.startswith("_")]
    if name not in ("ComparedResults", "Ranking", "Relations", "Validation"):
        assert set(parameters) <= documented, name
    if inspect.isfunction(thing):
        assert "Raises\n------" in text
        assert signature.return_annotation == "None" or "Returns\n-------" in text


@pytest.mark.parametrize("name", CLASSES)
def test_public_methods_say_what_they_do(name: str) -> None:
    for member, value in vars(getattr(aerocues, name)).items():
        if not member.startswith("_") and (
            inspect.isfunction(value) or isinstance(value, property)
        ):
            assert inspect.getdoc(value), f"{name}.{member}"


def test_functions_take_images_combinations_and_output_in_this_order() -> None:
    first = {
        name: [
            each.name
            for each in inspect.signature(getattr(aerocues, name)).parameters.values()
            if each.kind is each.POSITIONAL_OR_KEYWORD
        ]
        for name in FUNCTIONS
    }
    for name in ("run", "recommend", "reconstruct"):
        assert first[name] == ["dataset", "combinations", "output"]
    assert first["tune"] == ["dataset", "methods", "output"]
    assert first["use"] == ["dataset", "combination", "output"]
    assert first["simulate"] == ["survey", "output"]
    for name in ("score", "validate", "compare", "relate_outcomes"):
        assert first[name][:2] == ["results", "preset"]
    assert first["features"][:2] == ["image", "combination"]
    assert first["match"][:3] == ["image_1", "image_2", "combination"]


NAMED_ALIKE = (
    "run",
    "recommend",
    "reconstruct",
    "tune",
    "simulate",
    "use",
    "score",
    "validate",
    "compare",
)
# What the command line asks for, or finds out itself.
OF_THE_COMMAND = {"output", "dataset", "survey", "engine"}


@pytest.mark.parametrize("name", NAMED_ALIKE)
def test_defaults_are_those_of_the_command(name: str) -> None:
    program: Any = typer.main.get_command(app)
    options = {each.name: each for each in program.commands[name].params}
    function = inspect.signature(getattr(aerocues, name)).parameters
    shared = options.keys() & function.keys() - OF_THE_COMMAND
    assert len(shared) > 5
    for each in shared:
        ours, theirs = function[each].default, options[each].default
        theirs = getattr(theirs, "value", theirs)
        if each in ("budget", "timeout") and theirs is not None:
            ours, theirs = seconds_of(each, ours), seconds_of(each, theirs)
        empty = (None, (), inspect.Parameter.empty)
        assert ours == theirs or (ours in empty and theirs in empty), each


def test_images_come_in_any_form(photos: Path) -> None:
    files = sorted(photos.glob("*.png"))
    by_folder = aerocues.open_dataset(photos)
    forms: list[Any] = [str(photos), f"flight:{photos}", files, [str(file) for file in files]]
    for form in forms:
        opened = aerocues.open_dataset(form)
        assert [image.name for image in opened.images] == [f"{n}.png" for n in range(4)]
        assert [(pair.image_1, pair.image_2) for pair in opened.pairs] == [
            (pair.image_1, pair.image_2) for pair in by_folder.pairs
        ]
    turned = aerocues.open_dataset(files[::-1], max_pairs=1)
    assert [image.name for image in turned.images] == ["3.png", "2.png"]
    assert turned.source is not None
    again = aerocues.open_dataset(turned.source.spec)
    assert {image.name for image in turned.images} < {image.name for image in again.images}


@pytest.mark.parametrize("files", [[], ["0.png"], ["0.png", "0.png"], ["0.png", "missing.png"]])
def test_files_must_be_two_or_more_that_are_there(photos: Path, files: list[str]) -> None:
    with pytest.raises(aerocues.AerocuesError):
        aerocues.open_dataset([photos / name for name in files])


def test_a_measurement_from_python(photos: Path, tmp_path: Path) -> None:
    dataset = aerocues.open_dataset(photos, max_pairs=2)
    combinations: list[Combination | str] = [
        Combination.parse("ORB-ORB-HAM-BF"),
        "orb-brief-ham-bf",
    ]
    results = aerocues.run(dataset, combinations, tmp_path / "results", workers=1, seed=3)
    table = results.table()
    assert table["pair"].to_list() == [0, 0, 1, 1]
    assert set(table["status"]) == {"ok"}
    assert set(table["seed"]) == {3}
    assert results.status().left == 0
    best = aerocues.score(tmp_path / "results").frame()
    assert set(best["combination"]) == {"ORB-ORB-HAM-BF", "ORB-BRIEF-HAM-BF"}
    reopened = aerocues.Results(tmp_path / "results")
    assert reopened.sql("select count(*) as n from results")["n"].item() == 4


def test_one_combination_may_be_an_object(photos: Path, tmp_path: Path) -> None:
    one = Combination.parse("ORB-ORB-HAM-BF")
    kept = aerocues.run(photos, one, tmp_path / "r", timing="shared", max_keypoints=50, workers=1)
    assert max(kept.table()["keypoints_1"].to_list()) <= 50


def test_one_kind_of_event_tells_how_everything_goes_on(photos: Path, tmp_path: Path) -> None:
    events: list[Event] = []
    aerocues.run(
        photos, "ORB-ORB-HAM-BF", tmp_path / "r", timing="shared", workers=1, progress=events.append
    )
    assert {event.stage for event in events} == {"reading images", "measuring"}
    assert (events[-1].done, events[-1].total, events[-1].unit) == (3, 3, "rows")
    assert sum(len(event.rows) for event in events) == 3
    assert [event.message for event in events if event.message] == [
        "3 rows to measure in 1 unit of work"
    ]


@pytest.mark.parametrize("form", [str, Path, aerocues.Results])
def test_results_come_in_any_form(results: aerocues.Results, form: Callable[[Any], Any]) -> None:
    given = form(results.folder)
    ranking = aerocues.score(given, resamples=20)
    assert ranking.frame().columns[0] == "combination"
    validation = aerocues.validate(given, weights="entropy,critic", top=3)
    assert validation.scores.settings.weights == ("entropy", "critic")


def test_another_thing_is_not_results() -> None:
    with pytest.raises(ArgumentError, match="`results`"):
        aerocues.score(3)  # type: ignore[arg-type]


def test_features_and_matches_of_two_images(photos: Path) -> None:
    paths = photos / "0.png", str(photos / "1.png")
    found = aerocues.match(*paths, "orb-orb-ham-bf", max_keypoints=300)
    arrays = [cv2.imread(str(path)) for path in paths]
    one = Combination.parse("ORB-ORB-HAM-BF")
    again = aerocues.match(arrays[0], arrays[1], one, max_keypoints=300)
    assert str(found.combination) == "ORB-ORB-HAM-BF"
    assert len(found.features_1) <= 300
    assert found.points_1.shape == found.points_2.shape == (len(found.matches), 2)
    assert found.inliers.shape == (len(found.matches),)
    assert found.inliers.dtype == bool
    assert found.beats_chance
    assert found.geometry == "fundamental matrix"
    assert found.matrix is not None
    assert found.matrix.shape == (3, 3)
    np.testing.assert_array_equal(found.inliers, again.inliers)
    alone = aerocues.features(arrays[0], "ORB-ORB-HAM-BF", max_keypoints=300)
    np.testing.assert_array_equal(alone.keypoints.xy, found.features_1.keypoints.xy)
    # Inliers lie near their epipolar lines: Sampson's distance, in pixels.
    ones = np.ones((len(found.matches), 1))
    first, second = np.hstack([found.points_1, ones]), np.hstack([found.points_2, ones])
    lines_2, lines_1 = first @ found.matrix.T, second @ found.matrix
    algebraic = (second * lines_2).sum(axis=1)
    sampson = np.abs(algebraic) / np.sqrt(
        (lines_2[:, :2] ** 2).sum(axis=1) + (lines_1[:, :2] ** 2).sum(axis=1)
    )
    assert sampson[found.inliers].max() < 3.1
    assert found.picture(600).shape[1] == 600


def test_images_without_anything_in_common_have_no_geometry(photos: Path) -> None:
    blank = np.full((120, 160, 3), 128, np.uint8)
    found = aerocues.match(photos / "0.png", blank, "ORB-ORB-HAM-BF")
    assert (found.geometry, found.matrix, found.beats_chance) == (None, None, False)
    assert (len(found.matches), found.inliers.sum()) == (0, 0)
    assert "no model" in repr(found)


def test_objects_say_what_is_in_them(
    results: aerocues.Results, photos: Path, tmp_path: Path
) -> None:
    copy = shutil.copytree(results.folder, tmp_path / "copy")
    ranking = aerocues.score(results, resamples=20)
    best = ranking.frame()["combination"][0]
    assert repr(results).endswith("3 combinations on 3 pairs of photos, 9 rows: ok 9")
    assert f"; {best} is the best" in repr(ranking)
    shown = (
        results,
        ranking,
        aerocues.compare([results, copy]),
        aerocues.match(photos / "0.png", photos / "1.png", "ORB-ORB-HAM-BF"),
        aerocues.open_dataset(photos),
        aerocues.features(photos / "0.png", "ORB-ORB-HAM-BF"),
        aerocues.validate(results),
    )
    for each in shown:
        assert len(repr(each)) < 300
    for each in shown[:3]:
        html = each._repr_html_()
        assert best in html
        assert "<table" in html


@pytest.mark.slow
def test_a_flight_is_simulated_and_opened(tmp_path: Path) -> None:
    events: list[Event] = []
    mission = {"pattern": "nadir", "north": 10.0, "east": 0.1, "altitude": 40.0, "front": 0.9}
    flown = aerocues.simulate(
        mission, tmp_path / "flight", size=(48, 32), sun="120,40", progress=events.append
    )
    assert flown.name == "flight"
    assert flown.images[0].read().bgr.shape == (32, 48, 3)
    assert flown.images[0].truth is not None
    assert events[-1].done == events[-1].total == len(flown.images)
    again: list[Event] = []
    aerocues.simulate(
        mission, tmp_path / "flight", size="48x32", sun=(120, 40), progress=again.append
    )
    assert [event.done for event in again] == [len(flown.images)]


WRONG: list[tuple[str, dict[str, Any]]] = [
    ("run", {"timing": "none"}),
    ("run", {"workers": 0}),
    ("run", {"workers": "two"}),
    ("run", {"timeout": "soon"}),
    ("run", {"memory_limit": 0.1}),
    ("run", {"max_keypoints": -1}),
    ("run", {"seed": -1}),
    ("run", {"timing_pairs": -1}),
    ("run", {"timing_pairs": 3, "timing": "shared"}),
    ("run", {"spread": True}),
    ("run", {"preset": "nothing"}),
    ("recommend", {"budget": "0s"}),
    ("recommend", {"objective": "beauty"}),
    ("recommend", {"sure": 2}),
    ("recommend", {"max_pairs": 1}),
    ("recommend", {"workers": -1}),
    ("reconstruct", {"mapper": "other"}),
    ("reconstruct", {"intrinsics": "guess"}),
    ("reconstruct", {"focal_length": float("nan")}),
    ("reconstruct", {"workers": 0}),
    ("reconstruct", {"timeout": -1}),
    ("reconstruct", {"top": 3}),
]


@pytest.mark.parametrize(("name", "wrong"), WRONG)
def test_wrong_arguments_are_told_by_their_name(
    photos: Path, tmp_path: Path, name: str, wrong: dict[str, Any]
) -> None:
    with pytest.raises(AerocuesError) as raised:
        getattr(aerocues, name)(photos, COMBINATIONS, tmp_path / "out", **wrong)
    told = str(raised.value)
    assert any(f"`{each}" in told for each in wrong) or "preset" in wrong
    assert "--" not in told
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "wrong",
    [
        {"resamples": 1},
        {"interval": "wide"},
        {"test": "sign"},
        {"top_k": 0},
        {"criteria": "beauty"},
        {"weights": "mine"},
        {"alpha": 0},
        {"failures": "hide"},
        {"dataset": "other"},
    ],
)
def test_wrong_scoring_is_told(results: aerocues.Results, wrong: dict[str, Any]) -> None:
    with pytest.raises(AerocuesError, match=r"^[^-]*(?:-[^-]+)*$"):
        aerocues.score(results, **wrong)


@pytest.mark.parametrize(
    "wrong", [{"size": "large"}, {"sun": (1, 2, 3)}, {"scene": "sea"}, {"fov": 0}]
)
def test_wrong_flights_are_told(tmp_path: Path, wrong: dict[str, Any]) -> None:
    with pytest.raises(AerocuesError):
        aerocues.simulate("mini", tmp_path / "flight", **wrong)


def test_tuning_tells_wrong_arguments(photos: Path, tmp_path: Path) -> None:
    for wrong in ({"budget": "never"}, {"max_pairs": 2}, {"workers": 0}, {"objective": "beauty"}):
        with pytest.raises(AerocuesError):
            aerocues.tune(photos, "LATCH", tmp_path / "mine.json", **wrong)
    with pytest.raises(AerocuesError, match="NOTHING"):
        aerocues.tune([photos], ["NOTHING"], tmp_path / "mine.json")


@pytest.mark.parametrize(
    ("text", "seconds"), [("90s", 90), ("5min", 300), ("1.5 h", 5400), (12, 12), ("7", 7)]
)
def test_times_are_numbers_or_texts(text: str | float, seconds: float) -> None:
    assert seconds_of("budget", text) == seconds


def test_one_kind_of_error_covers_all(tmp_path: Path) -> None:
    with pytest.raises(AerocuesError):
        aerocues.open_dataset(str(tmp_path / "missing"))
    with pytest.raises(AerocuesError):
        aerocues.Results(tmp_path)
    with pytest.raises(AerocuesError):
        aerocues.match(tmp_path / "a.png", tmp_path / "b.png", "ORB-ORB-HAM-BF")
    with pytest.raises(AerocuesError):
        aerocues.features(np.zeros((4, 4)), "ORB-ORB-HAM-BF")  # type: ignore[arg-type]
