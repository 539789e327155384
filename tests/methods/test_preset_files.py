from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from aerocues.errors import SelectionError
from aerocues.methods.combination import Combination
from aerocues.methods.preset_files import (
    preset_of,
    read_preset,
    recorded_preset,
    tuned_record,
    write_preset,
)
from aerocues.methods.presets import Preset, preset_named, preset_names
from aerocues.methods.registry import Methods

MINE = Preset(
    "mine",
    "of my own",
    chance_test=True,
    detectors={"ORB": {"nlevels": 8}},
    descriptors={"LATCH": {"bytes": 32}},
    on_detectors={"ORB-BEBLID": {"scale_factor": 1.0}},
    thresholds={"ORB-ORB": 1.5},
)


def test_a_preset_is_read_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "mine.json"
    write_preset(path, MINE, {"by": "hand"})
    assert read_preset(path) == MINE
    assert preset_named(str(path)) == MINE
    assert json.loads(path.read_text())["made"] == {"by": "hand"}
    assert [each.name for each in tmp_path.iterdir()] == ["mine.json"]


def test_a_file_needs_only_what_differs_and_is_called_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "small.json"
    path.write_text('{"detectors": {"FAST": {"threshold": 12}}}')
    preset = read_preset(path)
    assert (preset.name, preset.chance_test) == ("small", True)
    assert preset.detectors == {"FAST": {"threshold": 12}}


def test_parameters_of_a_descriptor_may_depend_on_the_detector(methods: Methods) -> None:
    changed = methods.with_preset(MINE)
    assert changed.descriptor_on("BEBLID", "ORB").parameters["scale_factor"] == 1.0
    assert changed.descriptor_on("BEBLID", "FAST").parameters["scale_factor"] == 6.25
    orb, fast = (Combination.parse(f"{name}-BEBLID-HAM-BF") for name in ("ORB", "FAST"))
    assert changed.parameters(orb) != methods.parameters(orb)
    assert changed.parameters(fast) == methods.parameters(fast)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("nonsense", r"p\.json.* JSON \(line 1, column 1\)"),
        ("[1]", r"p\.json"),
        ('{"detector": {}}', r"\bdetector\b.* name, title"),
        ('{"detectors": {"ORB": 5}}', "detectors"),
        ('{"thresholds": {"ORB-ORB": -1}}', "thresholds"),
        ('{"name": "thesis"}', "thesis"),
        ('{"chance_test": "no"}', 'chance_test must be true or false, not "no"'),
        ('{"unbiased": 0}', "unbiased must be true or false, not 0"),
        ('{"title": ["a"]}', "title must be a text"),
        ('{"thresholds": {"ORB-ORB": Infinity}}', "Infinity is not a finite number"),
        ('{"thresholds": {"ORB-ORB": 1e999}}', "1e999 is not a finite number"),
        ('{"thresholds": {"ORB-ORB": true}}', "thresholds must hold pixels"),
        ('{"thresholds": {"ORB-ORB": NaN}}', "NaN is not a finite number"),
        ('{"detectors": {"ORB": {"nlevels": 8, "nlevels": 4}}}', '"nlevels" twice'),
        ('{"thresholds": {}, "thresholds": {}}', '"thresholds" twice'),
        ("[" * 100_000, "nested too deeply"),
        (f'{{"thresholds": {{"ORB-ORB": {"9" * 5000}}}}}', r"p\.json"),
        ('{"name": "Tuned"}', "Tuned"),
    ],
)
def test_what_is_no_preset_is_told_in_a_line(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "p.json"
    path.write_text(text)
    with pytest.raises(SelectionError, match=told):
        preset_named(str(path))


@pytest.mark.parametrize(
    ("parts", "told"),
    [
        ({"detectors": {"ORB": {"levels": 8}}}, r"ORB .*\blevels\b.* nfeatures"),
        ({"on_detectors": {"ORB-SURF": {"a": 1}}}, "descriptor SURF"),
        ({"on_detectors": {"ORB-LUCID": {"a": 1}}}, r"LUCID .*\ba\b.* lucid_"),
        ({"thresholds": {"SURF-ORB": 1.0}}, "detector SURF"),
    ],
)
def test_what_no_method_has_is_refused(methods: Methods, parts: dict[str, Any], told: str) -> None:
    with pytest.raises(SelectionError, match=told):
        methods.with_preset(preset_of({"name": "odd", **parts}, "odd.json"))


def test_a_run_remembers_its_preset_whole() -> None:
    from dataclasses import asdict

    for preset in (MINE, *map(preset_named, preset_names())):
        assert recorded_preset({"preset": preset.name, "preset_parts": asdict(preset)}) == preset
    assert recorded_preset({"preset": "thesis"}) == preset_named("thesis")


def test_the_preset_tuned_holds_what_its_searches_kept_and_nothing_else() -> None:
    preset = preset_named("Tuned")
    kept = [
        search for part in tuned_record()["made"] for search in part["searches"] if search["kept"]
    ]
    assert all(search["interval"][0] > 0 and search["gain"] >= 0.005 for search in kept)
    assert {search["search_space"] for search in kept if " on " not in search["search_space"]} == {
        *(f"detector {name}" for name in preset.detectors),
        *(f"descriptor {name}" for name in preset.descriptors),
    }
    assert preset.chance_test
    assert preset.descriptors["LATCH"]["bytes"] == 64


def test_the_preset_tuned_was_judged_on_scenes_that_it_was_not_chosen_by() -> None:
    for part in tuned_record()["made"]:
        chosen_by, judged_by = (
            {scene.partition(":")[0] for data in part["datasets"] for scene in data[side]}
            for side in ("training", "validation")
        )
        assert chosen_by
        assert judged_by
        assert not chosen_by & judged_by
