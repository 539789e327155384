"""What to type after a recommendation."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from aerocues.cli.next_commands import AsMeasured, next_commands
from aerocues.pipeline.equal_footing import Footing
from aerocues.results.reconstruction_schema import BASELINE
from tests.cli.test_recommendation import found
from tests.tuning.test_final import SIFT, final, model


def test_where_colmaps_default_wins_the_next_command_makes_its_model(photos: Path) -> None:
    same = AsMeasured("photos", None, None, None, None, "none", 900, "default", 8000, 0)
    recommended = found(photos, [0.7, 0.3])
    sharper = model(BASELINE, reprojection_error=0.5)
    won = replace(recommended, final=final(model(SIFT), sharper))
    first, *others = next_commands(won, same)
    assert first == (
        f"aerocues reconstruct photos --max-width 900 -o models --combinations {BASELINE} "
        f"--from {photos}"
    )
    assert f"aerocues use {SIFT} --from {photos} --as python" in others
    lost = replace(recommended, final=final(model(SIFT), model(BASELINE, points_in_3_images=9)))
    assert f" --combinations {SIFT} " in next_commands(lost, same)[0]
    assert " --combinations A-X-HAM-EXACT " in next_commands(recommended, same)[0]


def test_what_is_measured_next_has_the_thresholds_of_the_race(photos: Path) -> None:
    same = AsMeasured("photos", None, None, None, None, "none", 0, "default", 8000, 0)
    recommended = found(photos, [0.7, 0.3])
    asked = "aerocues run photos --max-keypoints 8000 "
    lowered = replace(
        recommended, footings=(Footing("SIFT", "contrastThreshold", 0.02, 1, 9000, reached=True),)
    )
    assert next_commands(recommended, same)[1].startswith(f"{asked}-o")
    assert next_commands(lowered, same)[1].startswith(f"{asked}--equal-footing -o")


def test_images_stay_upright_in_the_next_commands(photos: Path) -> None:
    same = AsMeasured(
        "photos", None, None, None, None, "none", 900, "default", 8000, 0, upright=True
    )
    model_command, run_command, *_ = next_commands(found(photos, [0.7, 0.3]), same)
    assert model_command.startswith("aerocues reconstruct photos --max-width 900 --upright -o")
    assert "--upright" in run_command
