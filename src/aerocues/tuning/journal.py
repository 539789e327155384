"""The steps of a race on disk, so that an interrupted race continues with the same decisions."""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, TypeGuard

from aerocues.results.hashing import content_hash
from aerocues.results.store import RACE
from aerocues.results.whole_files import json_content, write_whole

ANSWER = "answer"
"""Beside the journals, whose keys are hashes."""
NUMBER = int | float
FIGURES = ("probability", "seconds", "combinations", "measured", "measurements", "pairs")
# What reports read of an answer, of one of its rows and of its final.
ANSWER_SHAPE: Mapping[str, Any] = {
    **dict.fromkeys(("dataset", "title", "best", "leader", "ended"), str),
    **dict.fromkeys((*FIGURES, "candidates"), NUMBER),
    "ranked": list,
    "final": dict | None,
}
RANKED_SHAPE: Mapping[str, Any] = {
    "combination": str,
    **dict.fromkeys(("score", "probability"), NUMBER | None),
}
FINAL_SHAPE: Mapping[str, Any] = {"images": int, "of": int, "models": list, "unfinished": list}


@dataclass(frozen=True)
class Step:
    """Measurements requested together, and their result.

    Parameters
    ----------
    asked : str
        Hash of the requested row keys.
    spent : float
        Seconds from the start of the race to the end of the step.
    kept : float
        Seconds reserved for the time after the last step.
    missing : sequence of str
        Keys of rows that were not finished in time.
    """

    asked: str
    spent: float
    kept: float = 0.0
    missing: Sequence[str] = ()


@dataclass
class Journal:
    """The steps of one race, in the results folder.

    Times and unfinished rows are recorded because decisions depend on them; the measurements
    themselves are in the folder.

    Parameters
    ----------
    path : Path
    key : str
        Hash of everything that decisions depend on except the measurements and the budget.
    budget : float
        Seconds that the race has now.
    steps : list of Step
    begun : float
        Seconds spent, including interrupted and discarded steps.
    given : frozenset of str
        Keys of the rows that were there when the race began: an interrupted race knows no others
        from the start.
    """

    path: Path
    key: str
    budget: float
    steps: list[Step] = field(default_factory=list)
    begun: float = 0.0
    given: frozenset[str] = frozenset()
    _replayed: int = field(default=0, init=False)

    @classmethod
    def read(
        cls, folder: Path, key: str, budget: float, there: Iterable[str] = frozenset()
    ) -> Journal:
        """The journal of the race with this key; else an empty one that knows the rows there.

        With a larger budget than before, steps are kept only up to the first that lacked time: what
        it left out can be measured now.
        """
        path = folder / RACE
        try:
            content = _races(path)[key]
            given = frozenset(map(str, content["given"]))
            journal = cls(path, key, budget, begun=float(content["begun"]), given=given)
            journal.steps = [_step(**step) for step in content["steps"]]
            if budget > float(content["budget"]):
                complete = [not step.missing for step in journal.steps]
                journal._cut(complete.index(False) if False in complete else len(complete))
        except (KeyError, TypeError, ValueError, AttributeError):
            # No journal, or a damaged one: the measurements are kept independently of it.
            return cls(path, key, budget, given=frozenset(there))
        return journal

    @property
    def spent(self) -> float:
        """Seconds of all recorded work."""
        return max(self.steps[-1].spent if self.steps else 0.0, self.begun)

    def replay(self, keys: Sequence[str], there: Collection[str]) -> Step | None:
        """The next recorded step, if it requested the same rows and they are stored.

        Otherwise the race differs from the recorded one, and the remaining steps are discarded.
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
        """Record the time of an unfinished step."""
        self.begun = spent
        self._write()

    def _cut(self, place: int) -> None:
        self.begun = self.spent
        del self.steps[place:]

    def _write(self) -> None:
        own = {
            "budget": self.budget,
            "begun": self.begun,
            "given": sorted(self.given),
            "steps": [asdict(step) for step in self.steps],
        }
        write_whole({self.path: json_content({**_races(self.path), self.key: own})})


def record_answer(folder: Path, answer: Mapping[str, Any]) -> None:
    """Keep what the latest finished race found, for reports, beside its steps."""
    path = folder / RACE
    write_whole({path: json_content({**_races(path), ANSWER: dict(answer)})})


def recorded_answer(folder: Path) -> dict[str, Any] | None:
    """What the latest finished race in a results folder found; None if none, or a damaged one."""
    answer = _races(folder / RACE).get(ANSWER)
    return answer if _is_answer(answer) else None


def _is_answer(answer: Any) -> TypeGuard[dict[str, Any]]:
    if not _has_shape(answer, ANSWER_SHAPE):
        return False
    ranked, final = answer["ranked"], answer["final"]
    if not ranked or not all(_has_shape(row, RANKED_SHAPE) for row in ranked):
        return False
    if final is None:
        return True
    return _has_shape(final, FINAL_SHAPE) and all(
        isinstance(name, str) for name in (*final["models"], *final["unfinished"])
    )


def _has_shape(content: Any, shape: Mapping[str, Any]) -> bool:
    """Whether it is a mapping with these fields, each of the type."""
    return isinstance(content, dict) and all(
        name in content and isinstance(content[name], kind) for name, kind in shape.items()
    )


def _step(asked: str, spent: float, kept: float, missing: Sequence[str]) -> Step:
    """A step as it was recorded; raises what a damaged one deserves."""
    if not isinstance(missing, list) or not math.isfinite(float(spent) + float(kept)):
        raise ValueError("a step is damaged")
    return Step(str(asked), float(spent), float(kept), [str(key) for key in missing])


def _races(path: Path) -> dict[str, Any]:
    """What is in the file by key; empty if it cannot be read."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return content if isinstance(content, dict) else {}
