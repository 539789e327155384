"""Graded transformations are found by the names of images and sequences."""

from __future__ import annotations

import pytest

import aerocues
from aerocues.report.curves import curves_of, step_of


def pairs_of(dataset: aerocues.Dataset) -> list[dict[str, object]]:
    pairs = [
        {"sequence": pair.sequence, "image_1": pair.image_1, "image_2": pair.image_2}
        for pair in dataset.pairs
    ]
    return [{**pair, "step": step_of(dataset.name, pair)} for pair in pairs]


def test_the_transformations_of_one_image() -> None:
    found = pairs_of(aerocues.open_dataset("synthetic"))
    curves = {curve["name"]: curve for curve in curves_of("synthetic", found)}
    assert curves["rotation"]["x"] == [15, 30, 45, 60, 75, 90]
    assert curves["rotation"]["axis"] == "degrees"
    assert curves["scale"]["x"] == sorted(curves["scale"]["x"])
    assert sum(len(curve["pairs"]) for curve in curves.values()) == len(found) == 20


def test_every_transformation_has_an_axis() -> None:
    found = pairs_of(aerocues.open_dataset("synthetic-extended"))
    curves = curves_of("synthetic-extended", found)
    assert sum(len(curve["pairs"]) for curve in curves) == len(found)


@pytest.mark.parametrize(
    ("dataset", "sequence", "image", "axis"),
    [
        ("oxford", "graf", "img{}.ppm", "image (viewpoint)"),
        ("oxford", "mine", "img{}.png", "image"),
        ("hpatches", "i_dome", "{}.ppm", "image (illumination)"),
    ],
)
def test_the_images_of_a_sequence(dataset: str, sequence: str, image: str, axis: str) -> None:
    pairs = [
        {"sequence": sequence, "image_2": f"{sequence}/{image.format(number)}"}
        for number in (3, 2, 4)
    ]
    found = [{**pair, "step": step_of(dataset, pair)} for pair in pairs]
    assert curves_of(dataset, found) == [
        {"name": sequence, "axis": axis, "pairs": [1, 0, 2], "x": [2, 3, 4]}
    ]


def test_other_pairs_are_on_no_curve() -> None:
    pair = {"sequence": "", "image_1": "pair 0, image 1", "image_2": "pair 0, image 2"}
    assert step_of("oxford", pair) is None
    assert step_of("synthetic", pair) is None
    assert step_of("flight", {**pair, "sequence": "a", "image_2": "a/2.jpg"}) is None
    assert curves_of("flight", [{**pair, "step": None}]) == []
