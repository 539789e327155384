"""Presets in files: JSON that people and `aerocues tune` write."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path
from typing import Any

from aerocues.errors import SelectionError
from aerocues.json_files import read_json
from aerocues.methods.presets import Preset, preset_named, preset_names

_GROUPS = ("detectors", "descriptors", "on_detectors")
LARGEST_THRESHOLD = 1e6
"""Pixels: more than any image has."""
_KNOWN = ("name", "title", "chance_test", *_GROUPS, "thresholds", "unbiased", "made")


def read_preset(path: Path) -> Preset:
    """The preset in a file.

    Raises
    ------
    SelectionError
        If the file cannot be read or is no preset.
    """
    content = read_json(path, "the preset", SelectionError, f"give a JSON file with {_known()}")
    if not isinstance(content, dict):
        raise SelectionError(f"{path} is no preset: it must hold an object with {_known()}")
    return preset_of({"name": path.stem, **content}, str(path))


def preset_of(content: Mapping[str, Any], where: str) -> Preset:
    """A preset from its parts; `where` names the place that they come from.

    Raises
    ------
    SelectionError
        If a part is unknown or of a wrong type.
    """
    unknown = [name for name in content if name not in _KNOWN]
    if unknown:
        raise SelectionError(f"{where}: {unknown[0]} is unknown; a preset has {_known()}")
    name = _text(content, "name", "unnamed", where)
    if name.lower() in preset_names() and content != asdict(preset_named(name)):
        raise SelectionError(f"{where}: {name} is the name of another preset; choose a new one")
    return _assembled(content, where)


def tuned_preset() -> Preset:
    """The preset of parameters that were searched; benchmarks/tuned_preset.py made it."""
    return _assembled(tuned_record(), "the preset tuned")


def tuned_record() -> dict[str, Any]:
    """Everything in the file of the preset `tuned`, how it was made among it."""
    file = files("aerocues.methods").joinpath("tuned.json")
    content: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return content


def _assembled(content: Mapping[str, Any], where: str) -> Preset:
    groups: dict[str, Any] = {}
    for group in _GROUPS:
        groups[group] = content.get(group, {})
        if not _is_overrides(groups[group]):
            raise SelectionError(
                f"{where}: {group} must hold methods, each with parameters and their values, such "
                'as {"ORB": {"nlevels": 8}}'
            )
    thresholds = content.get("thresholds", {})
    if not isinstance(thresholds, dict) or not all(map(_is_pixels, thresholds.values())):
        raise SelectionError(f'{where}: thresholds must hold pixels, such as {{"ORB-BEBLID": 1.5}}')
    return Preset(
        name=_text(content, "name", "unnamed", where),
        title=_text(content, "title", f"from {where}", where),
        chance_test=_truth(content, "chance_test", where),
        **groups,
        thresholds={both: float(value) for both, value in thresholds.items()},
        unbiased=_truth(content, "unbiased", where),
    )


def _is_pixels(value: Any) -> bool:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return is_number and 0 < value < LARGEST_THRESHOLD


def _text(content: Mapping[str, Any], name: str, default: str, where: str) -> str:
    value = content.get(name, default)
    if not isinstance(value, str):
        raise SelectionError(f"{where}: {name} must be a text in double quotes, not {value!r}")
    return value


def _truth(content: Mapping[str, Any], name: str, where: str) -> bool:
    """Whether something is switched on; it is where nothing is said."""
    value = content.get(name, True)
    if not isinstance(value, bool):
        raise SelectionError(f"{where}: {name} must be true or false, not {json.dumps(value)}")
    return value


def recorded_preset(settings: Mapping[str, Any]) -> Preset:
    """The preset that a run recorded: its parts as they were then, else one of those known here.

    Runs that do not tell whether keypoints were put where they really are did not do so.

    Raises
    ------
    SelectionError
        If it is not known.
    """
    parts = settings.get("preset_parts")
    if parts:
        return _assembled({"unbiased": False, **parts}, "run.json")
    return preset_named(str(settings["preset"]))


def place_for_preset(path: Path) -> None:
    """Make sure that a preset can be written to a file, and be used from there.

    Raises
    ------
    SelectionError
        If it is a folder or cannot have one, or its name is that of another preset.
    """
    if path.is_dir():
        raise SelectionError(f"{path} is a folder; give a file for the preset, such as orb.json")
    if path.stem.lower() in preset_names():
        raise SelectionError(
            f"{path}: {path.stem} is the name of another preset; choose a new one, such as orb.json"
        )
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise SelectionError(
            f"{path} cannot be written ({error.strerror}: {error.filename}); choose another file"
        ) from error


def write_preset(path: Path, preset: Preset, made: Mapping[str, Any]) -> None:
    """Write a preset with a record of how it was made, beside its place and renamed."""
    part = path.with_name(f".{path.name}.part")
    text = json.dumps({**asdict(preset), "made": dict(made)}, indent=1)
    part.write_text(f"{text}\n", encoding="utf-8")
    part.replace(path)


def _is_overrides(group: Any) -> bool:
    return isinstance(group, dict) and all(
        isinstance(parameters, dict)
        and all(isinstance(value, bool | int | float | str) for value in parameters.values())
        for parameters in group.values()
    )


def _known() -> str:
    return ", ".join(_KNOWN)
