"""What a race has done so far, so that an interrupted one goes on as if nothing had been."""

from __future__ import annotations

import json
from collections.abc import Collection, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from aerocues.results.hashing import content_hash
from aerocues.results.store import RACE
from aerocues.results.whole_files import json_content, write_whole


@dataclass(frozen=True)
class Step:
    """What was asked for at once, and what came of it.

    Parameters
    ----------
    asked : str
        Hash of the row keys that were asked for.
    spent : float
        Seconds since the race began, when the step was over.
    kept : float
        Seconds that were set aside for what follows the last step.
    missing : sequence of str
        Row keys that were not obtained in time.
    """

    asked: str
    spent: float
    kept: float = 0.0
    missing: Sequence[str] = ()


@dataclass
class Journal:
    """The steps of one race, in the results folder.

    Their times and what was not obtained are recorded, as decisions depend on both; the
    measurements themselves are in the folder.

    Parameters
    ----------
    path : Path
    key : str
        Hash of all that the decisions depend on besides the measurements and the budget.
    budget : float
        Seconds that the race has now.
    steps : list of Step
    begun : float
        Seconds spent, those on steps that were interrupted or given up among them.
    """

    path: Path
    key: str
    budget: float
    steps: list[Step] = field(default_factory=list)
    begun: float = 0.0
    _replayed: int = field(default=0, init=False)

    @classmethod
    def read(cls, folder: Path, key: str, budget: float) -> Journal:
        """The journal of the race with this key; an empty one where there is none.

        What lack of time left undone under a smaller budget is to be done now, so that the steps
        from there on are not taken over.
        """
        path = folder / RACE
        try:
            content = _races(path)[key]
            journal = cls(path, key, budget, begun=float(content["begun"]))
            journal.steps = [Step(**step) for step in content["steps"]]
            if budget > float(content["budget"]):
                complete = [not step.missing for step in journal.steps]
                journal._cut(complete.index(False) if False in complete else len(complete))
        except (KeyError, TypeError, ValueError):
            # There is none, or it is damaged: the measurements are there all the same.
            return cls(path, key, budget)
        return journal

    @property
    def spent(self) -> float:
        """Seconds of everything that is recorded."""
        return max(self.steps[-1].spent if self.steps else 0.0, self.begun)

    def replay(self, keys: Sequence[str], there: Collection[str]) -> Step | None:
        """The next recorded step, if the same rows were asked for and are there.

        If not, the race has taken another way, and what is recorded from here on is void.
        """
        if self._replayed == len(self.steps):
            return None
        step = self.steps[self._replayed]
        if step.asked != content_hash(list(keys)) or set(keys) - set(step.missing) - set(there):
            self._cut(self._replayed)
            return None
        self._replayed += 1
        return step

    def add(self, keys: Sequence[str], spent: float, kept: float, missing: Sequence[str]) -> Step:
        """Record a step."""
        step = Step(content_hash(list(keys)), spent, kept, list(missing))
        self.steps.append(step)
        self._replayed = len(self.steps)
        self._write()
        return step

    def interrupt(self, spent: float) -> None:
        """Record the time of a step that is not finished."""
        self.begun = spent
        self._write()

    def _cut(self, place: int) -> None:
        self.begun = self.spent
        del self.steps[place:]

    def _write(self) -> None:
        own = {
            "budget": self.budget,
            "begun": self.begun,
            "steps": [asdict(step) for step in self.steps],
        }
        write_whole({self.path: json_content({**_races(self.path), self.key: own})})


def _races(path: Path) -> dict[str, Any]:
    """Everything that the file holds, by key; nothing where it cannot be read."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}
