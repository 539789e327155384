"""The final in words."""

from __future__ import annotations

from dataclasses import replace

import pytest

from aerocues.cli.final_words import headline, notes
from aerocues.results.reconstruction_schema import BASELINE
from tests.tuning.test_final import ORB, SIFT, final, model

LEADER = "ORB-ORB-HAM-BF"


def test_the_headline_names_the_best_model_and_colmaps_default_beside_it() -> None:
    found = final(model(SIFT), model(BASELINE, points_in_3_images=100, points_3d=1234))
    assert headline(found, LEADER) == (
        "Take SIFT-SIFT-L2-EXACT: 10 of 10 images in the model, 800 points seen by 3.5 images, "
        "1.00 px, in 10 s; COLMAP's default: 10 images, 1,234 points, 1.00 px, 10 s."
    )


def test_where_nothing_beats_colmaps_default_it_says_so() -> None:
    found = final(model(SIFT), model(BASELINE, reprojection_error=0.5))
    assert headline(found, LEADER).startswith("Take COLMAP's default: 10 of 10 images")
    assert "The best combination, SIFT-SIFT-L2-EXACT: 10 images, 800 points" in headline(
        found, LEADER
    )


def test_no_model_is_told() -> None:
    found = final(model(SIFT, status="no_model", registered_images=None))
    assert f"Take {LEADER}, which leads the race" in headline(found, LEADER)


def test_a_final_without_models_says_what_was_to_be_built() -> None:
    none = final()
    assert f"Take {LEADER}, which leads the race" in headline(none, LEADER)
    told = " ".join(notes(none))
    assert "no model of all images (10 of 10) was finished in time" in told
    assert f"no time for COLMAP's default, {ORB}, {SIFT}" in told


def test_colmaps_default_alone_is_told() -> None:
    alone = headline(final(model(BASELINE)), LEADER)
    assert alone.startswith(f"Take {LEADER}, which leads the race: only")
    assert alone.endswith("COLMAP's default was finished in time.")


@pytest.mark.parametrize(("images", "of", "short"), [(12, 18, True), (30, 90, False)])
def test_a_smaller_block_is_told(images: int, of: int, short: bool) -> None:
    told = " ".join(notes(replace(final(model(SIFT)), images=images, of=of)))
    assert f"a connected block of the flight ({images} of {of}" in told
    assert ("the time is too short for more" in told) is short


def test_notes_tell_who_came_close_and_who_had_no_time() -> None:
    found = final(model(SIFT), model(ORB, points_in_3_images=399))
    told = " ".join(notes(found))
    assert "ORB-ORB-HAM-EXACT is as good within 5%" in told
    assert "no time for COLMAP's default, STAR-BRISK-HAM-EXACT" in told
    assert "(10 of 10)" in told
