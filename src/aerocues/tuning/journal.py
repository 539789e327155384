"""What a race has done so far, so that an interrupted one goes on as if nothing had been."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from aerocues.evaluation.store import RACE
from aerocues.evaluation.whole_files import json_content, write_whole


@dataclass
class Journal:
    """The steps of one race, in the results folder.

    A step is what was asked for at once. Its time and what was not obtained are recorded, as
    decisions depend on both; the measurements themselves are in the folder.

    Parameters
    ----------
    path : Path
    key : str
        Hash of all that the decisions depend on besides the measurements.
    steps : list of (seconds spent in all, row keys that were not obtained)
    begun : float
        Seconds spent on a step that was interrupted.
    """

    path: Path
    key: str
    steps: list[tuple[float, list[str]]] = field(default_factory=list)
    begun: float = 0.0

    @classmethod
    def read(cls, folder: Path, key: str) -> Journal:
        """The journal of the race with this key; an empty one where there is none."""
        path = folder / RACE
        races = _races(path)
        try:
            content = races[key]
            steps = [(float(spent), list(missing)) for spent, missing in content["steps"]]
            return cls(path, key, steps, float(content["begun"]))
        except (KeyError, TypeError, ValueError):
            return cls(path, key)  # none, or damaged: what was measured is there all the same

    @property
    def spent(self) -> float:
        """Seconds of everything that is recorded."""
        return max(self.steps[-1][0] if self.steps else 0.0, self.begun)

    def add(self, spent: float, missing: Sequence[str]) -> None:
        """Record a step."""
        self.steps.append((spent, list(missing)))
        self._write()

    def interrupt(self, spent: float) -> None:
        """Record the time of a step that is not finished."""
        self.begun = spent
        self._write()

    def _write(self) -> None:
        races = {**_races(self.path), self.key: {"steps": self.steps, "begun": self.begun}}
        write_whole({self.path: json_content(races)})


def _races(path: Path) -> dict[str, Any]:
    """Everything that the file holds, by key; nothing where it cannot be read."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}
