"""Presets in files: JSON that people and `aerocues tune` write."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from aerocues.errors import SelectionError
from aerocues.methods.presets import PRESETS, Preset, preset_named

_GROUPS = ("detectors", "descriptors", "on_detectors")
_KNOWN = ("name", "title", "chance_test", *_GROUPS, "thresholds", "made")


def read_preset(path: Path) -> Preset:
    """The preset in a file.

    Raises
    ------
    SelectionError
        If the file cannot be read or is no preset.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise SelectionError(f"cannot read the preset {path}: {error}; it is JSON") from error
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
    name = str(content["name"])
    if name.lower() in {preset.name for preset in PRESETS} and content != asdict(_built_in(name)):
        raise SelectionError(f"{where}: {name} is the name of another preset; choose a new one")
    groups: dict[str, Any] = {}
    for group in _GROUPS:
        groups[group] = content.get(group, {})
        if not _is_overrides(groups[group]):
            raise SelectionError(
                f"{where}: {group} must hold methods, each with parameters and their values, such "
                'as {"ORB": {"nlevels": 8}}'
            )
    thresholds = content.get("thresholds", {})
    if not isinstance(thresholds, dict) or not all(
        isinstance(value, int | float) and value > 0 for value in thresholds.values()
    ):
        raise SelectionError(f'{where}: thresholds must hold pixels, such as {{"ORB-BEBLID": 1.5}}')
    return Preset(
        name=name,
        title=str(content.get("title", f"from {where}")),
        chance_test=bool(content.get("chance_test", True)),
        **groups,
        thresholds={both: float(value) for both, value in thresholds.items()},
    )


def recorded_preset(settings: Mapping[str, Any]) -> Preset:
    """The preset that a run recorded: one of those known here, or its parts.

    Raises
    ------
    SelectionError
        If it is not known.
    """
    parts = settings.get("preset_parts")
    return preset_of(parts, "run.json") if parts else preset_named(str(settings["preset"]))


def write_preset(path: Path, preset: Preset, made: Mapping[str, Any]) -> None:
    """Write a preset with a record of how it was made, beside its place and renamed."""
    part = path.with_name(f".{path.name}.part")
    text = json.dumps({**asdict(preset), "made": dict(made)}, indent=1)
    part.write_text(f"{text}\n", encoding="utf-8")
    part.replace(path)


def _built_in(name: str) -> Preset:
    return next(preset for preset in PRESETS if preset.name == name.lower())


def _is_overrides(group: Any) -> bool:
    return isinstance(group, dict) and all(
        isinstance(parameters, dict)
        and all(isinstance(value, bool | int | float | str) for value in parameters.values())
        for parameters in group.values()
    )


def _known() -> str:
    return ", ".join(_KNOWN)
