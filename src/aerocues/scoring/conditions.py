"""What a run was measured under: a row of the table each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import polars as pl


@dataclass(frozen=True)
class Condition:
    """One condition, and where it is written down.

    Attributes
    ----------
    name : str
    column : str
        Column of the rows; empty if only ``run.json`` knows it.
    place : tuple of str
        Keys in ``run.json``.
    form : str
        How a name tells the value.
    """

    name: str
    column: str = ""
    place: tuple[str, ...] = ()
    form: str = "{}"

    def told(self, value: str) -> str:
        """The value as a name of a run tells it."""
        return self.form.format(value)


CONDITIONS: tuple[Condition, ...] = (
    Condition("preset", "preset"),
    Condition("OpenCV", "opencv_version", form="OpenCV {}"),
    Condition("aerocues", place=("versions", "aerocues"), form="aerocues {}"),
    Condition("keypoints", "max_keypoints", form="{} keypoints"),
    Condition("keypoint choice", "keypoint_choice"),
    Condition("inlier threshold", "inlier_threshold", form="{} px"),
    Condition("width", place=("dataset", "settings", "max_width"), form="width {}"),
    Condition("equalize", place=("dataset", "settings", "equalize"), form="equalize {}"),
    Condition("seed", "seed", form="seed {}"),
)
ALWAYS_TOLD = ("preset", "OpenCV")


def conditions_of(rows: pl.DataFrame, settings: Mapping[str, Any]) -> dict[str, str]:
    """The conditions that are known, by name; several values are joined by a slash.

    Parameters
    ----------
    rows : pl.DataFrame
        Rows of one dataset by one machine.
    settings : mapping
        Content of ``run.json``.
    """
    found = {}
    for condition in CONDITIONS:
        if condition.column in rows.columns:
            values = rows[condition.column].drop_nulls().unique().sort().to_list()
        else:
            values = _at(settings, condition.place)
        if values:
            found[condition.name] = "/".join(map(_text, values))
    return found


def _at(settings: Any, place: Sequence[str]) -> list[Any]:
    if not place:
        return []
    for key in place:
        settings = settings.get(key) if isinstance(settings, Mapping) else None
    return [] if settings is None else [settings]


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def told_conditions(runs: Sequence[Mapping[str, str]]) -> list[str]:
    """The conditions of runs in words: preset and version of OpenCV, and all that differs.

    >>> told_conditions([{"preset": "default", "seed": "0"}, {"preset": "tuned", "seed": "0"}])
    ['preset default', 'preset tuned']
    """
    names = [
        condition.name
        for condition in CONDITIONS
        if condition.name in ALWAYS_TOLD or len({run.get(condition.name) for run in runs}) > 1
    ]
    return [
        ", ".join(f"{name} {run.get(name, 'unknown')}" for name in names if _told(name, runs))
        for run in runs
    ]


def _told(name: str, runs: Sequence[Mapping[str, str]]) -> bool:
    return any(name in run for run in runs)
