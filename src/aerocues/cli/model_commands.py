"""Commands to run after a reconstruction, with the paths of its files."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from aerocues.cli.models_table import of_combinations
from aerocues.cli.next_commands import AsMeasured
from aerocues.defaults import FLIGHT_KEYPOINTS
from aerocues.results.combination_columns import name_in_row
from aerocues.results.model_quality import best_first
from aerocues.results.reconstruction_schema import BASELINE

if TYPE_CHECKING:
    from aerocues.reconstruction.models import Models


def best_model(models: Models) -> str | None:
    """What made the best model of a folder, if only COLMAP's default; None if there is none.

    Where combinations were asked for, one of them must have succeeded.
    """
    table = best_first(models.table())
    others = of_combinations(table)
    if "ok" not in (others if len(others) else table)["status"]:
        return None
    return name_in_row(table.row(0, named=True))


def model_commands(
    models: Models, best: str | None, asked: AsMeasured, results: Path | None
) -> list[str]:
    """What to do next; nothing that needs a success where there is none.

    Parameters
    ----------
    models : Models
    best : str or None
        The combination whose model goes on, or COLMAP's default.
    asked : AsMeasured
        How the images were opened.
    results : path or None
        Results that the models were stored with.
    """
    commands = []
    if results is not None:
        commands += [["score", str(results), "--reconstruction"]] if best else []
        commands.append(["report", str(results)])
    elif best is None:
        commands.append(["recommend", asked.images, "--objective", "reconstruction"])
    lines = [shlex.join(["aerocues", *command]) for command in commands]
    return lines if best is None else [*lines, *_towards_a_map(models, best, asked, results)]


def _towards_a_map(models: Models, best: str, asked: AsMeasured, results: Path | None) -> list[str]:
    """Look at the best model; undistort its images for a dense cloud; let ODM make a map."""
    from aerocues.reconstruction.exports import MODEL, UNDISTORTED
    from aerocues.reconstruction.one_model import DATABASE
    from aerocues.reconstruction.scene import IMAGES

    place = models.path(best)
    model, images = str(place / MODEL / "0"), str(models.folder / IMAGES)
    dense = str(place / UNDISTORTED)
    look = ["colmap", "gui", "--import_path", model]
    look += ["--database_path", str(place / DATABASE), "--image_path", images]
    undistort = ["colmap", "image_undistorter", "--image_path", images]
    undistort += ["--input_path", model, "--output_path", dense]
    stereo = ["colmap", "patch_match_stereo", "--workspace_path", dense]
    output = f"{models.folder}-odm"
    use = ["aerocues", "use", best, *asked.words(FLIGHT_KEYPOINTS), "--as", "odm", "-o", output]
    use += [] if results is None else ["--from", str(results)]
    next_step = stereo if (place / UNDISTORTED).is_dir() else undistort
    own = [] if best == str(BASELINE) else [use]  # its features are COLMAP's own
    return [shlex.join(words) for words in (look, next_step, *own)]
