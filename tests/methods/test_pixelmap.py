"""PIXELMAP puts pixels where they are, in images of other sizes and turned ones, too."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from aerocues.methods import pixelmap
from aerocues.methods.combination import Combination
from aerocues.methods.compatibility import why_unavailable
from aerocues.methods.making import make_pair_matcher
from aerocues.methods.pixelmap import PixelMap
from aerocues.methods.registry import opencv_methods
from tests.methods.pictures import textured


def picture() -> NDArray[np.uint8]:
    return np.asarray(cv2.GaussianBlur(textured(), (0, 0), 1.5), np.uint8)


@pytest.mark.slow
@pytest.mark.parametrize("turned", [False, True])
def test_positions_have_no_shift(turned: bool) -> None:
    pytest.importorskip("pixelmap")
    first = picture()
    height, width = first.shape[:2]
    second = np.ascontiguousarray(first[::-1, ::-1] if turned else first[:-40, :-60])
    stage = make_pair_matcher(opencv_methods(), "PIXELMAP")
    found = stage.read(stage.call(first, second))
    truth = np.array([width - 1, height - 1]) - found.points_1 if turned else found.points_1
    error = found.points_2 - truth
    assert len(found) > 200
    assert np.abs(np.median(error, axis=0)).max() < 0.1
    assert (np.linalg.norm(error, axis=1) < 1).mean() > 0.9
    assert (found.points_2 < second.shape[1::-1]).all()
    again = stage.read(stage.call(first, second))
    assert np.array_equal(again.points_2, found.points_2)


def test_without_its_package_it_is_listed_as_unavailable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pixelmap, "find_spec", lambda name: None)
    reason = why_unavailable(Combination.of_pair_matcher("PIXELMAP"), opencv_methods())
    assert "aerocues[pixelmap]" in (reason or "")


class Stretched:
    """What PIXELMAP says of images of which the second is the first, four pixels to the right."""

    def lookup(self, x: NDArray[np.float32], y: NDArray[np.float32], *, backward: bool) -> object:
        return x + (-2 if backward else 2), y


def test_positions_are_those_of_the_images_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    module = type("module", (), {"correspond": lambda *images, **settings: Stretched()})
    monkeypatch.setitem(__import__("sys").modules, "pixelmap", module)
    image = np.zeros((100, 800, 3), np.uint8)
    first, second, scores = PixelMap("low", 50, 0).match_pair(image, image[:, :600])
    assert np.allclose(second - first, [4, 0], atol=1e-4)
    assert np.allclose(scores, 0, atol=1e-4)
    assert second[:, 0].max() < 600
    assert first[0].tolist() == [25, 25]
