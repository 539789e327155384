"""What is searched, under which names it is measured, and what becomes of the preset."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from aerocues.errors import SelectionError
from aerocues.methods.combination import Combination
from aerocues.methods.compatibility import why_incompatible
from aerocues.methods.making import make_descriptor, make_detector
from aerocues.methods.presets import Preset
from aerocues.methods.registry import opencv_methods
from aerocues.tuning.grids import GRIDS, read_grid, settings_of
from aerocues.tuning.search_spaces import SearchSpace, search_spaces_named, search_spaces_of

METHODS = opencv_methods()
EMPTY = Preset("p", "", chance_test=True)


def test_settings_hold_what_differs_and_begin_with_the_default() -> None:
    values = {"a": (1, 2), "b": (True, False)}
    found = settings_of(values, {"a": 2, "b": True, "c": 0})
    assert found == [{}, {"a": 1}, {"a": 1, "b": False}, {"b": False}]


def test_there_is_a_grid_for_every_method_whose_parameters_matter_alone() -> None:
    detectors = {row.method for row in GRIDS if row.kind == "detector"}
    descriptors = {row.method for row in GRIDS if row.kind == "descriptor"}
    usual = [
        {name for name, row in rows.items() if not row.on_request}
        for rows in (METHODS.detectors, METHODS.descriptors)
    ]
    assert detectors == usual[0]
    # What the parameters of these two decide as descriptors is decided with the detector.
    assert descriptors == usual[1] - {"SIFT", "ORB", "NONE"}


@pytest.mark.parametrize("space", search_spaces_of("all", METHODS), ids=lambda each: each.name)
def test_every_candidate_can_be_made(space: SearchSpace) -> None:
    assert why_incompatible(space.combination, METHODS) is None
    assert len(space.settings) > 1
    added = space.added(METHODS)
    names = [space.variant(number) for number in range(len(space.settings))]
    assert len(set(names)) == len(names)
    for named in names:
        assert Combination.parse(str(named)) == named
        make_detector(added, named.detector)
        make_descriptor(added, named.descriptor, named.detector)


def test_a_detector_takes_along_what_its_own_descriptor_shares() -> None:
    [space] = search_spaces_of("detector:orb", METHODS)
    setting = {"nlevels": 8}
    number = space.settings.index(setting)
    named = space.variant(number)
    added = space.added(METHODS)
    assert added.detectors[named.detector].parameters["nlevels"] == 8
    assert added.descriptors[named.descriptor].parameters["nlevels"] == 8
    assert added.detectors["ORB"].parameters["nlevels"] == 6
    preset = space.applied(EMPTY, setting, METHODS)
    assert preset.detectors == {"ORB": setting}
    assert preset.on_detectors == {"ORB-ORB": setting}
    assert preset.descriptors == {}


def test_a_descriptor_is_searched_by_itself_and_on_each_detector() -> None:
    first, *others = search_spaces_of("beblid", METHODS)
    assert (first.kind, first.name) == ("descriptor", "descriptor BEBLID")
    on = [name for name, row in METHODS.detectors.items() if not row.on_request]
    assert [each.combination.detector for each in others] == on
    assert others[2].name == "BEBLID on ORB"
    preset = first.applied(EMPTY, {"n_bits": 101}, METHODS)
    preset = others[2].applied(preset, {"scale_factor": 1.0}, METHODS)
    assert preset.descriptors == {"BEBLID": {"n_bits": 101}}
    assert preset.on_detectors == {"ORB-BEBLID": {"scale_factor": 1.0}}


def test_a_combination_is_searched_part_by_part() -> None:
    detector, pair, threshold = search_spaces_of("ORB-BEBLID-HAM-BF", METHODS)
    assert [each.kind for each in (detector, pair, threshold)] == ["detector", "pair", "threshold"]
    assert detector.applied(EMPTY, {"nlevels": 8}, METHODS).on_detectors == {}
    number = threshold.settings.index({"threshold": 1.5})
    named = threshold.variant(number)
    assert threshold.thresholds()[f"{named.detector}-{named.descriptor}"] == 1.5
    rows = threshold.added(METHODS).descriptors
    assert rows[named.descriptor].parameters == METHODS.descriptors["BEBLID"].parameters
    assert threshold.applied(EMPTY, {"threshold": 1.5}, METHODS).thresholds == {"ORB-BEBLID": 1.5}


def test_values_of_ones_own_are_tried(tmp_path: Path) -> None:
    file = tmp_path / "grid.json"
    file.write_text(json.dumps({"threshold": [5, 15], "nonmaxSuppression": [True]}))
    [space] = search_spaces_of("FAST", METHODS, read_grid(file))
    assert space.settings == ({}, {"threshold": 15})
    [descriptor] = search_spaces_of(
        "descriptor:ORB", METHODS, {"WTA_K": (2,), "patchSize": (25, 31)}
    )
    assert (descriptor.kind, descriptor.settings) == ("descriptor", ({}, {"patchSize": 25}))
    with pytest.raises(SelectionError, match=r"FAST .*\bsize\b.*threshold"):
        search_spaces_of("FAST", METHODS, {"size": (1,)})
    for content in ("{", "[]", "{}", '{"a": 5}', '{"a": [[5]]}'):
        file.write_text(content)
        with pytest.raises(SelectionError, match="grid"):
            read_grid(file)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("SURF", "SURF"),
        ("detector:LATCH", "DETECTOR:LATCH"),
        ("SIFT-ORB-HAM-BF", "SIFT-ORB-HAM-BF"),
        ("SIFT-SURF-L2-BF", "descriptor SURF"),
    ],
)
def test_what_cannot_be_searched_is_told(text: str, words: str) -> None:
    with pytest.raises(SelectionError, match=words):
        search_spaces_of(text, METHODS)


@pytest.mark.parametrize("text", ["ORB-BEBLID-HAM-BF", "all", "detector:all"])
def test_values_of_ones_own_are_for_one_method(text: str) -> None:
    with pytest.raises(SelectionError, match=f"`grid` .*{text}"):
        search_spaces_of(text, METHODS, {"nlevels": (6,)})


def test_a_grid_is_for_the_kind_that_is_named() -> None:
    with pytest.raises(SelectionError, match="DETECTOR:LATCH"):
        search_spaces_of("detector:LATCH", METHODS, {"bytes": (2, 32)})


@pytest.mark.parametrize(
    "names",
    [
        ("ORB-BEBLID-HAM-BF", "ORB-BRIEF-HAM-BF"),
        ("ORB-BEBLID-HAM-BF", "ORB-BEBLID-HAM-FLANN"),
        ("detector:ORB", "ORB-BEBLID-HAM-BF"),
        ("BEBLID", "ORB-BEBLID-HAM-BF"),
        ("AGAST-LATCH-HAM-BF", "LATCH"),
    ],
)
def test_what_would_be_mixed_without_being_measured_is_refused(names: tuple[str, ...]) -> None:
    with pytest.raises(SelectionError, match=names[1]):
        search_spaces_named(names, METHODS)


def test_what_is_named_twice_is_searched_once() -> None:
    once = search_spaces_named(["all"], METHODS)
    assert search_spaces_named(["ORB", "all", "detector:orb"], METHODS) == [
        *search_spaces_of("ORB", METHODS),
        *(each for each in once if each.name != "detector ORB"),
    ]
    assert len(search_spaces_named(["ORB-BEBLID-HAM-BF", "AGAST-BRIEF-HAM-BF"], METHODS)) == 6
    with pytest.raises(SelectionError, match="method"):
        search_spaces_named([], METHODS)
