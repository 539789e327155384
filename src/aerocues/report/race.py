"""What a race found, in the payload: its own answer, and how much of the table it measured."""

from __future__ import annotations

from typing import Any

from aerocues.results.measured_results import Results
from aerocues.results.store import RACE
from aerocues.tuning.journal import recorded_answer


def race_facts(results: Results, dataset: str) -> dict[str, Any] | None:
    """The answer of the latest race on a dataset, as `Recommendation.facts` tells it.

    None where no race was run; ``{"unfinished": True}`` where none was finished.
    """
    folder = results.folder
    if not (folder / RACE).is_file():
        return None
    answer = recorded_answer(folder)
    if answer is None:
        return {"unfinished": True}
    return answer if answer["dataset"] == dataset else None
