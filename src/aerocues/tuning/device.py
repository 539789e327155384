"""Times on another machine: times measured here, scaled by a factor for each stage and method."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aerocues.errors import SelectionError
from aerocues.json_files import read_json
from aerocues.results.metrics import Row, add_metrics

ANY = "*"
STAGES: dict[str, tuple[str, ...]] = {
    "detect": ("detect_seconds_1", "detect_seconds_2"),
    "describe": ("describe_seconds_1", "describe_seconds_2"),
    "match": ("match_seconds",),
    "verify": ("verify_seconds",),
}
_NEXT_STEP = "write one with 'aerocues compare HERE THERE --factors FILE'"


@dataclass(frozen=True)
class Device:
    """Another machine.

    Parameters
    ----------
    name : str
    factors : mapping of stage to mapping of method to float
        Seconds there / seconds here: for detect by detector, for describe by descriptor, for match
        by norm and matcher (``L2-BF``); ``*`` stands for all others.
    """

    name: str
    factors: Mapping[str, Mapping[str, float]]

    def there(self, row: Row) -> Row:
        """The row with the times of the device."""
        method = {
            "detect": row["detector"],
            "describe": row["descriptor"],
            "match": f"{row['norm']}-{row['matcher']}",
        }
        scaled = dict(row)
        for stage, columns in STAGES.items():
            own = self.factors[stage]
            factor = own.get(str(method.get(stage, ANY)), own[ANY])
            for name in (*columns, *(f"{column}_cpu" for column in columns)):
                value = row[name]
                scaled[name] = factor * value if isinstance(value, int | float) else None
        return add_metrics(scaled)


def read_device(path: Path) -> Device:
    """The device in a file of factors.

    Raises
    ------
    SelectionError
        If the file cannot be read or has no factors.
    """
    content = read_json(path, "the factors", SelectionError, _NEXT_STEP)
    stages = content.get("stages") if isinstance(content, dict) else None
    if not isinstance(stages, dict) or not all(_are_factors(stages.get(name)) for name in STAGES):
        raise SelectionError(
            f"{path} is not a file of factors: it needs 'stages' with {', '.join(STAGES)}, each "
            f"with positive numbers, one of them for '{ANY}'; {_NEXT_STEP}"
        )
    return Device(str(content.get("machine", path.stem)), stages)


def _are_factors(found: Any) -> bool:
    return (
        isinstance(found, dict)
        and ANY in found
        and all(isinstance(value, int | float) and value > 0 for value in found.values())
    )
