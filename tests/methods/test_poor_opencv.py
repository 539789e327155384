"""Builds of OpenCV that lack methods, as those of boards often do."""

from __future__ import annotations

import cv2
import pytest

from aerocues.errors import SelectionError
from aerocues.methods.counting import count_combinations
from aerocues.methods.explanation import explain
from aerocues.methods.registry import opencv_methods
from aerocues.methods.selection import select


@pytest.fixture
def without_contributed_modules(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(cv2, "xfeatures2d")


@pytest.mark.opencv_versions
@pytest.mark.usefixtures("without_contributed_modules")
def test_what_is_missing_is_unavailable_with_the_reason() -> None:
    methods = opencv_methods()
    assert methods.detectors["SIFT"].unavailable is None
    assert methods.descriptors["ORB"].unavailable is None
    reason = methods.detectors["STAR"].unavailable
    assert reason is not None
    assert "StarDetector" in reason
    assert "opencv-contrib-python-headless" in reason
    assert "FREAK is unavailable: this OpenCV" in explain("ORB-FREAK-HAM-BF", methods)


@pytest.mark.usefixtures("without_contributed_modules")
def test_what_is_missing_does_not_take_part() -> None:
    methods = opencv_methods()
    counts = count_combinations(methods)
    assert counts.unavailable > 0
    chosen = select(methods)
    assert len(chosen) == counts.meaningful < 340
    assert not {each.detector for each in chosen} & {"STAR", "HL", "MSD", "TBMR"}
    with pytest.raises(SelectionError, match=r"STAR .*OpenCV"):
        select(methods, "STAR-*")


def test_a_full_build_has_everything() -> None:
    methods = opencv_methods()
    assert [row.name for row in methods.detectors.values() if row.unavailable] == []
    assert [row.name for row in methods.descriptors.values() if row.unavailable] == []
