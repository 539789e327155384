"""Methods that a program registers without packaging them."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from aerocues.errors import MethodUnavailableError, SelectionError
from aerocues.methods import plugins
from aerocues.methods.explanation import explain
from aerocues.methods.plugins import installed_methods, register, register_class
from aerocues.methods.registry import opencv_methods
from aerocues.methods.selection import select
from aerocues.methods.strongest import limited

CODE = """
import numpy as np

from aerocues.methods.arrays import Features, Keypoints, Matches


class Corners:
    def detect(self, image):
        return Keypoints.from_xy(np.zeros((0, 2)))


class Pixels:
    dtype = "float32"
    parameters = {"radius": 2}

    def __init__(self, radius):
        self.radius = radius

    def describe(self, image, keypoints):
        return Features(keypoints, np.zeros((len(keypoints), 4), np.float32))


class Both:
    name = "corner_pixels"
    dtype = "float32"

    def extract(self, image):
        return Features(Keypoints.from_xy(np.zeros((0, 2))), np.zeros((0, 4), np.float32))


class None_:
    dtypes = {"L2": ("float32",)}

    def match(self, features_1, features_2, norm):
        return Matches()


class OfPixels(None_):
    takes_descriptors = ("pixels",)
    upright = True


class Unsure(None_):
    upright = "sometimes"


class Numbers(None_):
    takes_descriptors = (1, 2)


class Weighty(None_):
    on_request = "heavy"
    needs_file = {"path": "weights.bin", "variable": "OWN_WEIGHTS", "remedy": "download it"}


class Weights(Pixels):
    on_request = "heavy"
    needs_file = Weighty.needs_file


class OfOthers(None_):
    on_request = "heavy"
    takes_descriptors = ("OTHERS",)


class Many(Corners):
    parameters = {"count": 900, "step": 2}
    limit = "count"


class Limitless(Corners):
    limit = "count"


class Nowhere(None_):
    needs_file = {"variable": "OWN_WEIGHTS"}


class Odd:
    dtype = "float64"


def made():
    return Corners()
"""


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The name of a module that can be imported; what it registers is forgotten again."""
    monkeypatch.setattr(plugins, "_REGISTERED", {})
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "own_methods.py").write_text(CODE)
    importlib.invalidate_caches()
    yield "own_methods"
    sys.modules.pop("own_methods", None)


def test_each_kind_is_listed_and_combined(module: str) -> None:
    register("detector", "corners", f"{module}:Corners")
    register("descriptor", "PIXELS", f"{module}:Pixels")
    register("matcher", "NOTHING", f"{module}:None_")
    register("extractor", "BOTH", f"{module}:Both")
    methods = installed_methods()
    assert methods.descriptors["PIXELS"].parameters == {"radius": 2}
    assert methods.descriptors["PIXELS"].factory == "own_methods:Pixels"
    assert "CORNERS" in methods.detectors
    assert [str(each) for each in select(methods, "CORNERS-PIXELS-L2-NOTHING,BOTH-BOTH-*-BF")] == [
        "CORNERS-PIXELS-L2-NOTHING",
        "BOTH-BOTH-L2-BF",
    ]
    assert methods.problems == ()


def test_a_matcher_takes_the_descriptors_that_it_was_made_for(module: str) -> None:
    register("descriptor", "PIXELS", f"{module}:Pixels")
    register("matcher", "OFPIXELS", f"{module}:OfPixels")
    methods = installed_methods()
    assert methods.matchers["OFPIXELS"].upright
    assert not methods.descriptors["PIXELS"].upright
    chosen = select(methods, "*-OFPIXELS")
    assert {each.descriptor for each in chosen} == {"PIXELS"}
    assert explain("SIFT-PIXELS-L2-OFPIXELS", methods) == "SIFT-PIXELS-L2-OFPIXELS runs"
    for text in ("SIFT-SIFT-L2-OFPIXELS", "ORB-ORB-HAM-OFPIXELS"):
        told = explain(text, methods)
        assert told.startswith(f"{text} cannot run: OFPIXELS matches PIXELS descriptors only")
        with pytest.raises(SelectionError, match="PIXELS descriptors only"):
            select(methods, text)


def test_a_method_is_unavailable_as_long_as_its_file_is_missing(
    module: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    register("matcher", "WEIGHTY", f"{module}:Weighty")
    told = "WEIGHTY is unavailable: weights.bin does not exist; download it"
    for asked in ("SIFT-SIFT-L2-WEIGHTY", "SIFT-*,+heavy"):
        with pytest.raises(SelectionError, match=told):
            select(installed_methods(), asked)
    (tmp_path / "weights.bin").touch()
    assert len(select(installed_methods(), "SIFT-SIFT-L2-WEIGHTY")) == 1
    monkeypatch.setenv("OWN_WEIGHTS", str(tmp_path / "others.bin"))
    assert "others.bin" in explain("SIFT-SIFT-L2-WEIGHTY", installed_methods())
    for unfit in ("~nosuchuser/weights.bin", "long" * 1000):
        monkeypatch.setenv("OWN_WEIGHTS", unfit)
        assert f"{unfit} cannot be opened" in explain("SIFT-SIFT-L2-WEIGHTY", installed_methods())


def test_a_set_of_which_nothing_can_be_used_says_why(
    module: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    register("matcher", "OFOTHERS", f"{module}:OfOthers")
    with pytest.raises(SelectionError, match="OFOTHERS matches OTHERS descriptors only"):
        select(installed_methods(), "*,+heavy")
    register("descriptor", "WEIGHTS", f"{module}:Weights")
    with pytest.raises(SelectionError, match=r"WEIGHTS is unavailable: weights.bin does not"):
        select(installed_methods(), "*,+heavy")


def test_a_detector_that_limits_itself_is_told_how_many_keypoints_are_kept(module: str) -> None:
    register("detector", "MANY", f"{module}:Many")
    methods = installed_methods()
    assert limited(methods, 500).detectors["MANY"].parameters == {"count": 500, "step": 2}
    assert limited(methods, 1000).detectors["MANY"].parameters["count"] == 900


def test_a_class_of_a_module_stands_for_its_name(module: str) -> None:
    register("detector", "CORNERS", importlib.import_module(module).Corners)
    assert installed_methods().detectors["CORNERS"].factory == "own_methods:Corners"
    with pytest.raises(MethodUnavailableError, match="mymodule"):
        register("detector", "CORNERS", type("Corners", (), {"__module__": "__main__"}))


def test_changed_source_makes_another_method(module: str, tmp_path: Path) -> None:
    register("descriptor", "PIXELS", f"{module}:Pixels")
    before = installed_methods().descriptors["PIXELS"].origin
    register("descriptor", "PIXELS", f"{module}:Pixels")
    assert installed_methods().descriptors["PIXELS"].origin == before
    (tmp_path / "own_methods.py").write_text(f"{CODE}\n# faster\n")
    register("descriptor", "PIXELS", f"{module}:Pixels")
    assert installed_methods().descriptors["PIXELS"].origin != before


@pytest.mark.parametrize(
    ("kind", "name", "method", "error"),
    [
        ("detectors", "CORNERS", "own_methods:Corners", SelectionError),
        ("detector", "my-corners", "own_methods:Corners", SelectionError),
        ("descriptor", "SIFT", "own_methods:Pixels", SelectionError),
        ("matcher", "EXACT", "own_methods:None_", SelectionError),
        ("extractor", "VGG", "own_methods:Both", SelectionError),
        ("detector", "CORNERS", "own_methods:Missing", MethodUnavailableError),
        ("detector", "CORNERS", "missing_module:Corners", MethodUnavailableError),
        ("detector", "CORNERS", "no reference", MethodUnavailableError),
        ("descriptor", "ODD", "own_methods:Odd", MethodUnavailableError),
        ("matcher", "UNSURE", "own_methods:Unsure", MethodUnavailableError),
        ("matcher", "NUMBERS", "own_methods:Numbers", MethodUnavailableError),
        ("detector", "LIMITLESS", "own_methods:Limitless", MethodUnavailableError),
        ("matcher", "NOWHERE", "own_methods:Nowhere", MethodUnavailableError),
    ],
)
def test_what_cannot_be_registered_is_refused(
    module: str, kind: str, name: str, method: str, error: type[Exception]
) -> None:
    with pytest.raises(error):
        register(kind, name, method)
    assert installed_methods() == opencv_methods()


def test_a_plug_in_of_the_command_line_tells_its_kind_and_name(module: str) -> None:
    for name in ("Corners", "Pixels", "Both", "None_"):
        register_class(f"{module}:{name}")
    methods = installed_methods()
    assert {"CORNERS", "CORNER_PIXELS"} <= set(methods.detectors)
    assert {"PIXELS", "CORNER_PIXELS"} <= set(methods.descriptors)
    assert "NONE_" in methods.matchers
    for reference in (f"{module}:made", f"{module}:Missing", "missing_module:X", "a b"):
        with pytest.raises(MethodUnavailableError):
            register_class(reference)
