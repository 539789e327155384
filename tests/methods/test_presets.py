from __future__ import annotations

from typing import Any

import pytest

from aerocues.errors import SelectionError
from aerocues.methods.combination import Combination
from aerocues.methods.presets import Preset, preset_named, preset_names
from aerocues.methods.registry import Methods


def test_presets_are_found_in_any_case() -> None:
    assert preset_named("Thesis").chance_test is False
    assert preset_named("default").chance_test is True


def test_an_unknown_preset_names_the_known() -> None:
    with pytest.raises(SelectionError, match="default, thesis, tuned"):
        preset_named("best")


def test_every_preset_fits_the_methods(methods: Methods) -> None:
    for name in preset_names():
        changed = methods.with_preset(preset_named(name))
        assert list(changed.detectors) == list(methods.detectors)


def test_a_preset_changes_what_it_names_and_nothing_else(methods: Methods) -> None:
    preset = Preset(
        "x", "x", True, {"ORB": {"nfeatures": 7}}, {"LATCH": {"bytes": 32}}, unbiased=False
    )
    changed = methods.with_preset(preset)
    assert changed.detectors["ORB"].parameters["nfeatures"] == 7
    assert changed.detectors["ORB"].parameters["nlevels"] == 6
    assert changed.descriptors["LATCH"].parameters["bytes"] == 32
    assert changed.descriptors["ORB"] == methods.descriptors["ORB"]
    before, after = (
        m.parameters(Combination.parse("ORB-LATCH-HAM-BF")) for m in (methods, changed)
    )
    assert before != after


@pytest.mark.parametrize("kind", ["detectors", "descriptors"])
def test_a_preset_of_an_unknown_method_is_refused(methods: Methods, kind: str) -> None:
    parts: dict[str, Any] = {kind: {"SURF": {"size": 1}}}
    preset = Preset("odd", "odd", True, **parts)
    with pytest.raises(SelectionError, match=r"\bodd\b.* SURF"):
        methods.with_preset(preset)
