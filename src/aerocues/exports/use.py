"""The function that takes a combination elsewhere, as users of the library call it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aerocues.errors import ArgumentError
from aerocues.exports.recipe import Measured, recipe_of
from aerocues.exports.targets import Target, target_named
from aerocues.methods.combination import Combination
from aerocues.methods.presets import Preset, as_preset
from aerocues.modelling import best_combinations, preset_of_results
from aerocues.results.measured_results import Results, as_results
from aerocues.results.whole_files import write_whole


@dataclass(frozen=True)
class Used:
    """A combination in the form of something else.

    Parameters
    ----------
    target : str
        What it was written as.
    combination : str
    path : path or None
        Where it was written; None if nowhere.
    text : str
        The program.
    """

    target: str
    combination: str
    path: Path | None
    text: str

    def __str__(self) -> str:
        return self.text


def use(
    combination: str | Combination | None = None,
    output: str | Path | None = None,
    *,
    target: str,
    results: Results | str | Path | None = None,
    preset: str | Preset | None = None,
    max_keypoints: int | None = None,
    max_width: int | None = None,
    equalize: str | None = None,
    seed: int | None = None,
) -> Used:
    """Use a combination elsewhere: as a program in OpenCV alone.

    Parameters
    ----------
    combination : str or Combination, optional
        By default the best of `results`.
    output : path, optional
        File of the program; without it, nothing is written.
    target : {"python", "cpp"}
        What it is to be.
    results : Results or path, optional
        Results that it was measured in; everything else is then as it was measured there.
    preset : str or Preset, optional
        Parameters of the methods; by default those of `results`, or ``"default"``.
    max_keypoints : int, optional
        The strongest keypoints that are kept in an image; 0 keeps all. By default as in `results`,
        or all.
    max_width : int, optional
        Wider images are shrunk to so many pixels; 0 for images as they are. By default as in
        `results`, or as they are.
    equalize : {"none", "histogram", "clahe"}, optional
        By default as in `results`, or none.
    seed : int, optional
        By default that of `results`, or 0.

    Returns
    -------
    Used

    Raises
    ------
    AerocuesError
        If an argument makes no sense, there is no such combination, or OpenCV alone cannot do it.
    """
    row = target_named(target)
    measured = None if results is None else as_results(results)
    name = _named(combination, measured)
    given = {
        "max_keypoints": max_keypoints,
        "max_width": max_width,
        "equalize": equalize,
        "seed": seed,
    }
    settings = _settings(measured, preset, given)
    return _program(row, name, settings, None if output is None else Path(output))


def _named(combination: str | Combination | None, results: Results | None) -> str:
    if combination is not None:
        return str(combination)
    if results is None:
        raise ArgumentError(
            "there is no combination; give one, such as ORB-BEBLID-HAM-BF, or measured `results`"
        )
    dataset = results.settings.get("dataset", {}).get("name")
    return best_combinations(results, dataset, 1)[0]


def _settings(
    results: Results | None, preset: str | Preset | None, given: Mapping[str, Any]
) -> Measured:
    """How it was measured, where nothing else is asked for."""
    facts = {} if results is None else results.settings
    protocol, dataset = facts.get("protocol", {}), facts.get("dataset", {})
    limit, read = protocol.get("limit", {}), dataset.get("settings", {})
    width = str(read.get("max_width", "full"))
    recorded = {
        "max_keypoints": limit.get("count", 0),
        "max_width": 0 if width == "full" else int(width),
        "equalize": read.get("equalize", "none"),
        "seed": protocol.get("seed", 0),
    }
    values = {**recorded, **{name: value for name, value in given.items() if value is not None}}
    values["max_width"] = values["max_width"] or None
    return Measured(
        preset=as_preset(preset or preset_of_results(results)),
        spread=bool(values["max_keypoints"]) and limit.get("spread", False),
        geometry=dataset.get("geometry", "epipolar"),
        **values,
    )


def _program(row: Target, combination: str, settings: Measured, output: Path | None) -> Used:
    recipe = recipe_of(combination, settings)
    text = str(row.load()(recipe))
    if output is not None:
        write_whole({output: text.encode()})
    return Used(row.name, str(recipe.combination), output, text)
