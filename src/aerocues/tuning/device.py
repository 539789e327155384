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


def as_device(device: Device | Mapping[str, Any] | str | Path | None) -> Device | None:
    """A device as it is, or that of factors or of a file of them; None stays.

    Raises
    ------
    SelectionError
        If the file cannot be read or has no factors.
    """
    if device is None or isinstance(device, Device):
        return device
    if isinstance(device, Mapping):
        return _device_of(device, "the device", "device")
    path = Path(device)
    content = read_json(path, "the factors", SelectionError, _NEXT_STEP)
    return _device_of(content, str(path), path.stem)


def _device_of(content: Any, where: str, name: str) -> Device:
    stages = content.get("stages") if isinstance(content, Mapping) else None
    if not isinstance(stages, Mapping) or not all(_are_factors(stages.get(n)) for n in STAGES):
        raise SelectionError(
            f"{where} does not hold factors: it needs 'stages' with {', '.join(STAGES)}, each "
            f"with positive numbers, one of them for '{ANY}'; {_NEXT_STEP}"
        )
    return Device(str(content.get("machine", name)), stages)


def _are_factors(found: Any) -> bool:
    return (
        isinstance(found, dict)
        and ANY in found
        and all(isinstance(value, int | float) and value > 0 for value in found.values())
    )
