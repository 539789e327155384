from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aerocues.datasets.catalog import open_dataset
from aerocues.pipeline.flight_pairs import SurveyedFlight, leaves_pairs_open, survey_flight
from tests.pipeline.test_survey import made_up


def test_a_flight_gets_pairs_across_its_strips(strips: Path) -> None:
    dataset = open_dataset(strips)
    assert leaves_pairs_open(dataset)
    assert next((p.image_1, p.image_2) for p in dataset.pairs) == ("0.png", "1.png")
    found = survey_flight(dataset, 4, 0, lambda done, total: None)
    assert found is not None
    classes = found.classes_of(range(len(found.dataset.pairs)))
    assert set(classes.tolist()) == {0, 1}
    names = {name for pair in found.dataset.pairs for name in (pair.image_1, pair.image_2)}
    assert names == {image.name for image in dataset.images}
    number = len(found.dataset.pairs)
    assert dict(found.dataset.settings)["pairs"].startswith(f"representative:{number}:")
    assert "turned" in found.notes()[0]


def test_pairs_that_somebody_chose_stay(strips: Path) -> None:
    assert not leaves_pairs_open(open_dataset(strips, pairs="exhaustive"))
    assert not leaves_pairs_open(open_dataset("synthetic"))
    assert not leaves_pairs_open(replace(open_dataset(strips), source=None))


def test_what_a_survey_warns_of(strips: Path) -> None:
    survey = replace(made_up(), pairs=made_up().pairs[:1], unreadable=(("3", "broken"),))
    found = survey_flight(open_dataset(strips), 4, 0, lambda done, total: None)
    assert found is not None
    notes = SurveyedFlight(found.dataset, survey, found.chosen).notes()
    assert any(" of 24 images overlap with no other: 2, 4, 5, ..." in note for note in notes)
    assert any("1 of 24 images cannot be read: 3" in note for note in notes)
    assert np.array_equal(survey.partners()[:3], [1, 1, 0])


@pytest.mark.slow
def test_a_survey_is_made_once(strips: Path, tmp_path: Path) -> None:
    looks: list[int] = []

    def look(seed: int, *, keep: bool = True) -> SurveyedFlight:
        looks.clear()
        found = survey_flight(
            open_dataset(strips),
            4,
            seed,
            lambda done, total: looks.append(done),
            tmp_path,
            keep=keep,
        )
        assert found is not None
        return found

    look(0, keep=False)
    assert not any(tmp_path.iterdir())
    first = look(0)
    assert looks
    assert look(0).survey == first.survey
    assert not looks
    look(1)
    assert looks
    for file in tmp_path.iterdir():
        file.write_text('{"images": 7}')
    assert look(0).survey == first.survey
    assert looks
