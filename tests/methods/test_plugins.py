from __future__ import annotations

import importlib
import os
import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import psutil
import pytest

from aerocues.errors import SelectionError
from aerocues.methods import plugin_trial
from aerocues.methods.arrays import Features, Keypoints, Matches
from aerocues.methods.combination import Combination
from aerocues.methods.compatibility import why_incompatible, why_unavailable
from aerocues.methods.counting import count_combinations
from aerocues.methods.making import (
    ArrayDescriptor,
    ArrayDetector,
    ArrayMatcher,
    make_descriptor,
    make_detector,
    make_matcher,
)
from aerocues.methods.plugins import installed_methods
from aerocues.methods.presets import preset_named
from aerocues.methods.registry import Methods, opencv_methods
from aerocues.methods.selection import runnable, select
from tests.methods.arena import CODE, ENTRY_POINTS
from tests.methods.distribution import EntryPoints, write_distribution
from tests.methods.pictures import shifted_pair
from tests.waiting import wait_until


@pytest.fixture(scope="module")
def arena_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A distribution with one method of each kind; each is tried once, and remembered."""
    folder = tmp_path_factory.mktemp("arena")
    write_distribution(folder, "feature-arena", ENTRY_POINTS, CODE, version="0.3")
    return folder


@pytest.fixture
def arena(arena_folder: Path, monkeypatch: pytest.MonkeyPatch) -> Methods:
    monkeypatch.syspath_prepend(arena_folder)
    forget(monkeypatch, "arena")
    return installed_methods()


Install = Callable[[str, EntryPoints, Mapping[str, str]], Methods]


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Install:
    """Install a distribution and list the methods."""
    monkeypatch.syspath_prepend(tmp_path)

    def installed(name: str, entry_points: EntryPoints, code: Mapping[str, str]) -> Methods:
        write_distribution(tmp_path, name, entry_points, code)
        importlib.invalidate_caches()
        for path in code:
            forget(monkeypatch, path.split("/")[0])
        return installed_methods()

    return installed


def forget(monkeypatch: pytest.MonkeyPatch, package: str) -> None:
    for name in [name for name in sys.modules if name.split(".")[0] == package]:
        monkeypatch.delitem(sys.modules, name)


def test_every_kind_of_plug_in_is_listed_with_where_it_comes_from(arena: Methods) -> None:
    assert {"CORNERS", "CORNER_BITS", "NEEDY"} <= set(arena.detectors)
    assert {"PATCHES", "CORNER_BITS", "MISTYPED"} <= set(arena.descriptors)
    assert "MUTUAL" in arena.matchers
    row = arena.detectors["CORNERS"]
    assert row.origin == "feature-arena 0.3"
    assert row.reference == "Nobody, Corners by two differences, 2024"
    assert row.parameters == {"step": 1}
    assert arena.descriptors["PATCHES"].dtype == "float32"
    assert arena.descriptors["CORNER_BITS"].bit_string
    mutual = arena.matchers["MUTUAL"]
    assert mutual.title == "mutual neighbours in numpy"
    assert (mutual.takes_descriptors, mutual.upright) == (("PATCHES", "SIFT"), True)


def test_the_methods_of_opencv_stay_as_they_are(arena: Methods) -> None:
    assert set(runnable(opencv_methods())) <= set(runnable(arena))
    opencv = opencv_methods()
    for name, row in opencv.detectors.items():
        assert arena.detectors[name] == row


def test_what_misses_a_dependency_is_unavailable_with_the_reason(arena: Methods) -> None:
    reason = why_unavailable(Combination.parse("NEEDY-ORB-HAM-BF"), arena)
    assert reason is not None
    assert "No module named 'package_that_nobody_has'" in reason
    reason = why_unavailable(Combination.parse("ORB-MISTYPED-L2-BF"), arena)
    assert reason is not None
    assert "arena.methods:Patchs" in reason
    assert not [c for c in runnable(arena) if "NEEDY" in str(c) or "MISTYPED" in str(c)]
    with pytest.raises(SelectionError, match="NEEDY"):
        select(arena, "NEEDY-ORB-HAM-BF")


def test_plug_ins_combine_with_opencv_by_type_and_norm(arena: Methods) -> None:
    chosen = {str(c) for c in select(arena, "CORNERS-*,*-PATCHES-*,CORNER_BITS-*,*-MUTUAL")}
    assert {
        "CORNERS-ORB-HAM-BF",
        "CORNERS-PATCHES-L2-MUTUAL",
        "SIFT-PATCHES-L2-FLANN",
        "SIFT-SIFT-L2-MUTUAL",
        "CORNER_BITS-CORNER_BITS-HAM-FLANN",
        "CORNER_BITS-SIFT-L2-BF",
    } <= chosen
    assert "CORNERS-AKAZE-HAM-BF" not in chosen
    for text, words in (
        ("ORB-CORNER_BITS-HAM-BF", "needs what only keypoints of CORNER_BITS carry"),
        ("SIFT-SIFT-HAM-MUTUAL", "MUTUAL does not know the norm HAM"),
        ("ORB-ORB-L2-MUTUAL", "MUTUAL matches PATCHES or SIFT descriptors only, not ORB"),
        ("CORNERS-PATCHES-HAM-BF", "PATCHES descriptors are float32 numbers"),
    ):
        assert words in (why_incompatible(Combination.parse(text), arena) or "")


def test_plug_ins_detect_describe_and_match(arena: Methods) -> None:
    images = shifted_pair(shift=(7, 4))
    for text in ("CORNERS-PATCHES-L2-MUTUAL", "CORNER_BITS-CORNER_BITS-HAM-BF"):
        names = Combination.parse(text)
        detector = make_detector(arena, names.detector)
        descriptor = make_descriptor(arena, names.descriptor)
        matcher = make_matcher(arena, names.matcher, names.norm)
        first, second = (
            descriptor.read(
                descriptor.call(
                    image, descriptor.prepare(detector.read(detector.call(image)), image)
                )
            )
            for image in images
        )
        matches = matcher.read(matcher.call(first, second))
        moved = (
            first.keypoints.xy[matches.indices[:, 0]] - second.keypoints.xy[matches.indices[:, 1]]
        )
        assert len(matches) > 50
        assert (np.abs(moved - (7, 4)).max(axis=1) == 0).mean() > 0.5


def test_parameters_decide_what_a_plug_in_finds(arena: Methods) -> None:
    image, _ = shifted_pair()
    detector = make_detector(arena, "CORNERS")
    found = detector.read(detector.call(image))
    content = arena.parameters(Combination.parse("CORNERS-ORB-HAM-BF"))
    assert content["detector"] == ["feature-arena 0.3", "arena.methods:Corners", {"step": 1}]
    assert len(found) == 200
    assert arena.with_preset(preset_named("thesis")).detectors == arena.detectors


@pytest.mark.parametrize(
    ("entry_points", "words"),
    [
        (
            {"detectors": {"orb": "arena.methods:Corners"}},
            "'orb', which is left out: opencv has a detector of that name",
        ),
        ({"matchers": {"BF": "arena.methods:Mutual"}}, "'BF', which is left out"),
        (
            {"extractors": {"sift": "arena.methods:CornerBits"}},
            "'sift', which is left out",
        ),
        (
            {"extractors": {"VGG": "arena.methods:CornerBits"}},
            "opencv has a descriptor",
        ),
        ({"detectors": {"my-corners": "arena.methods:Corners"}}, "'my-corners', which is left out"),
        ({"descriptors": {"a b": "arena.methods:Patches"}}, "'a b', which is left out: a name may"),
    ],
)
def test_a_taken_or_malformed_name_is_left_out_and_told_with_the_package(
    install: Install, entry_points: dict[str, dict[str, str]], words: str
) -> None:
    methods = install("clashing", entry_points, CODE)
    (problem,) = methods.problems
    assert words in problem
    assert "the plug-in clashing 1.2" in problem
    assert "rename its entry point" in problem
    assert without_problems(methods) == opencv_methods()
    assert methods.with_preset(preset_named("thesis")).problems == methods.problems


def without_problems(methods: Methods) -> Methods:
    return replace(methods, problems=())


def test_of_two_plug_ins_of_one_name_the_first_is_kept(install: Install) -> None:
    install("one", {"detectors": {"CORNERS": "arena.methods:Corners"}}, CODE)
    methods = install("two", {"extractors": {"corners": "arena.methods:CornerBits"}}, CODE)
    assert methods.detectors["CORNERS"].origin == "one 1.2"
    assert "CORNERS" not in methods.descriptors
    assert "the plug-in two 1.2 offers 'corners'" in methods.problems[0]
    assert "one 1.2 has a detector of that name" in methods.problems[0]


BAD = """
class Doubles:
    dtype = "float64"

class Speechless:
    pass

class Module:
    def parameters(self):
        return iter(())

class Listed:
    parameters = ["size", 3]

class Device:
    parameters = {"device": object()}

class Numbered:
    parameters = {1: 2}

class ListedTypes:
    dtypes = ["float32"]

class NoTypes:
    dtypes = {"L2": None}

class OtherTypes:
    dtypes = {"L2": ("float32", "int8")}

class Standing:
    upright = 1

class Choosy:
    dtypes = {"L2": ("float32",)}
    takes_descriptors = (3,)

class Evil(type):
    @property
    def reference(cls):
        raise RuntimeError("not to be asked")

class Asked(metaclass=Evil):
    pass
"""


@pytest.mark.parametrize(
    ("group", "value", "told"),
    [
        ("descriptors", "unfit.methods:Doubles", "'float64'"),
        ("matchers", "unfit.methods:Speechless", "dtypes"),
        ("detectors", "unfit.burnt:Anything", "RuntimeError: no accelerator here"),
        ("extractors", "unfit.methods:Module", "'parameters' must be a mapping"),
        ("detectors", "unfit.methods:Listed", "names to values, not a list"),
        ("descriptors", "unfit.methods:Device", "'parameters' must be numbers and texts"),
        ("matchers", "unfit.methods:Module", "'parameters' must be a mapping"),
        ("detectors", "unfit.methods:Numbered", "the names of its 'parameters' must be texts"),
        ("matchers", "unfit.methods:ListedTypes", "norms to descriptor types, not a list"),
        ("matchers", "unfit.methods:NoTypes", "TypeError"),
        ("matchers", "unfit.methods:OtherTypes", "'int8'"),
        ("detectors", "unfit.methods:Standing", "'upright' must be True or False"),
        ("matchers", "unfit.methods:Choosy", "'takes_descriptors' must be names"),
        ("detectors", "unfit.methods:Asked", "RuntimeError: not to be asked"),
        ("detectors", "unfit.leaving:Anything", "SystemExit: 3"),
        ("detectors", "unfit.silent:Anything", "ImportError"),
        ("descriptors", "unfit.several:Anything", "first line second line"),
        ("detectors", "no reference", "does not exist"),
    ],
)
def test_a_plug_in_that_cannot_be_used_is_listed_with_the_reason(
    install: Install, group: str, value: str, told: str
) -> None:
    code = {
        "unfit/__init__.py": "",
        "unfit/methods.py": BAD,
        "unfit/burnt.py": "raise RuntimeError('no accelerator here')",
        "unfit/leaving.py": "raise SystemExit(3)",
        "unfit/silent.py": "raise ImportError",
        "unfit/several.py": r"raise ImportError('first line\nsecond line')",
    }
    methods = install("unfit", {group: {"UNFIT": value}}, code)
    rows = [
        table["UNFIT"]
        for table in (methods.detectors, methods.descriptors, methods.matchers)
        if "UNFIT" in table
    ]
    assert len(rows) == (2 if group == "extractors" else 1)
    for row in rows:
        assert told in (row.unavailable or "")
    assert methods.problems == ()
    assert runnable(methods) == runnable(opencv_methods())
    assert count_combinations(methods).unavailable > 0


GOOD = "class Anything:\n    parameters = {'size': 3}\n"
MISBEHAVING = {
    "crashes": ("import os; os.abort()", "SIGABRT"),
    "kills itself": ("import os, signal; os.kill(os.getpid(), signal.SIGKILL)", "SIGKILL"),
    "exits": ("import os; os._exit(7)", "exit code 7"),
    "exits well": ("import os; os._exit(0)", "exit code 0"),
    "hangs": ("import time; time.sleep(1000)", "did not end within 2 seconds"),
    "hangs deaf": (
        "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); time.sleep(1000)",
        "did not end within 2 seconds",
    ),
    "prints": ("print('hello from me')", "it prints to standard output .*hello from me"),
    "prints below Python": ("import os; os.write(1, b'hi')", "it prints to standard output"),
    "forks": ("import os; os.fork()", "fork"),
    "closes": ("import os; os.close(1)", "closes standard output"),
    "closes in Python": ("import sys; sys.stdout.close()", "closes standard output"),
    "interrupts": ("raise KeyboardInterrupt", "ended the process"),
    "is no Python": ("class", "SyntaxError"),
}


@pytest.mark.parametrize("how", MISBEHAVING)
def test_a_plug_in_that_misbehaves_when_it_is_imported_is_listed_as_unavailable(
    install: Install, monkeypatch: pytest.MonkeyPatch, how: str
) -> None:
    monkeypatch.setattr(plugin_trial, "SECONDS", 2.0 if "hangs" in how else 60.0)
    source, told = MISBEHAVING[how]
    code = {"rogue.py": f"{source}\n{GOOD}", "kind.py": GOOD}
    offered = {"detectors": {"ROGUE": "rogue:Anything", "KIND": "kind:Anything"}}
    methods = install("rogue", offered, code)
    assert re.search(told, methods.detectors["ROGUE"].unavailable or "")
    assert methods.detectors["KIND"].unavailable is None
    assert methods.detectors["KIND"].parameters == {"size": 3}
    assert "rogue" not in sys.modules
    assert set(runnable(opencv_methods())) <= set(runnable(methods))


def test_threads_and_processes_of_an_import_end_with_it(install: Install, tmp_path: Path) -> None:
    source = """
import subprocess, sys, threading, time
threading.Thread(target=time.sleep, args=[1000]).start()
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(1000)"])
open("PLACE", "w").write(str(child.pid))
""".replace("PLACE", str(tmp_path / "pid"))
    methods = install("busy", {"detectors": {"BUSY": "busy:Anything"}}, {"busy.py": source + GOOD})
    assert methods.detectors["BUSY"].unavailable is None
    number = int((tmp_path / "pid").read_text())
    wait_until(lambda: not psutil.pid_exists(number) or is_zombie(number))


def is_zombie(number: int) -> bool:
    try:
        return psutil.Process(number).status() == psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return True


@pytest.mark.slow
def test_what_was_said_is_remembered_until_files_change(
    install: Install, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = f"open({str(tmp_path / 'count')!r}, 'a').write('x')\n"
    offered = {"detectors": {"COUNTED": "counted:Anything", "BROKEN": "broken:Anything"}}
    code = {"counted.py": source + GOOD, "broken.py": source + "raise OSError"}
    first = install("counted", offered, code)
    assert (tmp_path / "count").read_text() == "xx"
    assert installed_methods() == first
    assert (tmp_path / "count").read_text() == "xx"
    (tmp_path / "broken.py").write_text(source + GOOD)
    assert installed_methods().detectors["BROKEN"].unavailable is None
    assert (tmp_path / "count").read_text() == "xxx"
    for file in (Path(os.environ["AEROCUES_CACHE"]) / "plug-ins").iterdir():
        file.write_text("[" * 10**5)
    assert installed_methods().detectors["COUNTED"] == first.detectors["COUNTED"]
    monkeypatch.setenv("AEROCUES_CACHE", "/dev/null/nowhere")
    assert installed_methods().detectors["COUNTED"] == first.detectors["COUNTED"]


@pytest.mark.parametrize(
    ("asked", "left"),
    [
        ("none", set()),
        ("", set()),
        ("CORNERS", {"CORNERS"}),
        ("corners, mutual", {"CORNERS", "MUTUAL"}),
        ("feature-arena", {"CORNERS", "PATCHES", "CORNER_BITS", "NEEDY", "MISTYPED", "MUTUAL"}),
    ],
)
def test_plug_ins_are_chosen_by_the_environment(
    arena: Methods, monkeypatch: pytest.MonkeyPatch, asked: str, left: set[str]
) -> None:
    monkeypatch.setenv("AEROCUES_PLUGINS", asked)
    methods, opencv = installed_methods(), opencv_methods()
    named = {*methods.detectors, *methods.descriptors, *methods.matchers}
    assert named - {*opencv.detectors, *opencv.descriptors, *opencv.matchers} == left
    assert methods.problems == ()


def test_a_chosen_plug_in_that_is_not_there_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("AEROCUES_PLUGINS", "MISSING,none")
    [problem] = installed_methods().problems
    assert "'missing'" in problem


class Returns:
    """A third-party method that returns what it was made with."""

    def __init__(self, result: object) -> None:
        self.result = result

    def detect(self, image: object) -> object:
        return self.result

    def describe(self, image: object, keypoints: object) -> object:
        return self.result

    def match(self, features_1: object, features_2: object, norm: str) -> object:
        return self.result


IMAGE = np.zeros((20, 20, 3), np.uint8)
THREE = Keypoints.from_xy(np.arange(6.0).reshape(3, 2))
NOWHERE = Keypoints.from_xy(np.full((3, 2), np.nan))


@pytest.mark.parametrize("result", [None, [1, 2], np.zeros((3, 2)), NOWHERE])
def test_a_detector_that_returns_nonsense_is_caught(result: object) -> None:
    stage = ArrayDetector(Returns(result))
    with pytest.raises((TypeError, ValueError)):
        stage.read(stage.call(IMAGE))


@pytest.mark.parametrize("result", [None, THREE, Features(THREE, np.zeros((3, 4), np.uint8))])
def test_a_descriptor_that_returns_nonsense_is_caught(result: object) -> None:
    stage = ArrayDescriptor(Returns(result), "float32")
    with pytest.raises(TypeError):
        stage.read(stage.call(IMAGE, stage.prepare(THREE, IMAGE)))


def test_descriptors_that_are_not_finite_are_dropped() -> None:
    rows = np.array([[1, 2], [np.nan, 1], [3, np.inf]], np.float32)
    stage = ArrayDescriptor(Returns(Features(THREE, rows)), "float32")
    features = stage.read(stage.call(IMAGE, stage.prepare(THREE, IMAGE)))
    assert features.descriptors.tolist() == [[1, 2]]
    assert features.keypoints.xy.tolist() == [[0, 1]]


def test_descriptors_are_made_contiguous_as_opencv_needs_them() -> None:
    rows = np.zeros((3, 40), np.uint8)[:, :32]
    stage = ArrayDescriptor(Returns(Features(THREE, rows)), "uint8")
    features = stage.read(stage.call(IMAGE, stage.prepare(THREE, IMAGE)))
    assert features.descriptors.flags.c_contiguous


def pairs(*indices: tuple[int, int]) -> Matches:
    return Matches(np.array(indices, np.int32), np.zeros(len(indices), np.float32))


@pytest.mark.parametrize(
    "result",
    [None, [(0, 0)], pairs((0, 1), (0, 2)), pairs((0, 1), (2, 1)), pairs((0, 3)), pairs((-1, 0))],
)
def test_a_matcher_that_returns_nonsense_is_caught(result: object) -> None:
    features = Features(THREE, np.zeros((3, 4), np.float32))
    stage = ArrayMatcher(Returns(result), "L2")
    with pytest.raises((TypeError, ValueError)):
        stage.read(stage.call(features, features))
