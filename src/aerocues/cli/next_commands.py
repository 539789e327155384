"""Commands to run after a recommendation, with the options of the recommendation."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from typing import TYPE_CHECKING

from aerocues.defaults import FLIGHT_KEYPOINTS
from aerocues.methods.combination import Combination
from aerocues.results.combination_columns import name_in_row

if TYPE_CHECKING:
    from aerocues.tuning.recommendation import Recommendation

FEW = 3


@dataclass(frozen=True)
class AsMeasured:
    """How images were opened and measured, as options of the command line.

    Parameters
    ----------
    images : str
    pairs, subset : str or None
    band : int or None
    every : str or None
    equalize : str
    max_width : int
        0 for the full size.
    preset : str
    max_keypoints : int
        0 for all.
    seed : int
    plugins : tuple of str
        Methods of the user's own, as ``module:Class``.
    upright : bool
        Whether images are turned to a common heading.
    """

    images: str
    pairs: str | None
    subset: str | None
    band: int | None
    every: str | None
    equalize: str
    max_width: int
    preset: str
    max_keypoints: int
    seed: int
    plugins: tuple[str, ...] = ()
    upright: bool = False

    def words(self, max_keypoints: int) -> list[str]:
        """Images and options that differ from the defaults of `run` and `reconstruct`.

        Parameters
        ----------
        max_keypoints : int
            The default of the command.
        """
        options = (
            ("--pairs", self.pairs, None),
            ("--subset", self.subset, None),
            ("--band", self.band, None),
            ("--every", self.every, None),
            ("--equalize", self.equalize, "none"),
            ("--max-width", self.max_width, 0),
            ("--preset", self.preset, "default"),
            ("--max-keypoints", self.max_keypoints, max_keypoints),
            ("--seed", self.seed, 0),
        )
        words = [self.images]
        for name, value, default in options:
            words += [name, f"{value}"] if value != default else []
        words += ["--upright"] if self.upright else []
        for plugin in self.plugins:
            words += ["--plugin", plugin]
        return words


def next_commands(found: Recommendation, measured: AsMeasured) -> list[str]:
    """Commands that continue from a recommendation; models only for scenes with depth.

    The model is that of COLMAP's default where nothing beats it.
    """
    few = ",".join(found.ranked["combination"].head(FEW))
    footing = ["--equal-footing"] if any(each.steps for each in found.footings) else []
    final = found.final.best_combination if found.final else None
    best = name_in_row(final) if final else found.leader
    commands = [
        ["run", *measured.words(0), *footing, "-o", "results", "--combinations", few],
        ["report", str(found.folder)],
        ["use", best, "--from", str(found.folder), "--as", "python"],
    ]
    if found.dataset.geometry == "epipolar":
        words = [
            "-o",
            "models",
            *_one_scene(found),
            "--combinations",
            found.best if final else quickly_matched(best),
        ]
        words += ["--from", str(found.folder)]
        commands.insert(0, ["reconstruct", *measured.words(FLIGHT_KEYPOINTS), *words])
    return [shlex.join(["aerocues", *command]) for command in commands]


def quickly_matched(name: str) -> str:
    """The same with the exact matcher in place of brute force, as models are built in a final."""
    from aerocues.modelling.final import exactly_matched

    combination = Combination.parse(name)
    return str(exactly_matched(combination)) if combination.matcher == "BF" else name


def _one_scene(found: Recommendation) -> list[str]:
    """Options for one scene: the first if there are several."""
    scenes = list(dict.fromkeys(pair.sequence for pair in found.dataset.pairs))
    return ["--sequences", scenes[0]] if len(scenes) > 1 else []
