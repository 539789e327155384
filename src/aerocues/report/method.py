"""The section on the method: definitions, incompatible combinations, citation."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product
from typing import Any

from aerocues.errors import SelectionError
from aerocues.methods.combination import Combination
from aerocues.methods.compatibility import why_incompatible, why_meaningless
from aerocues.methods.plugins import installed_methods
from aerocues.report.columns import criterion_facts
from aerocues.report.words import WORDS
from aerocues.results.metrics import METRICS
from aerocues.results.schema import COLUMNS
from aerocues.results.statuses import STATUSES

CITATION = (
    "aerocues {version}, and the thesis that it is based on: Towards Efficient 3D Reconstruction "
    "from UAV Imagery: Evaluation of Feature Detection, Description and Matching Combinations. "
    "PhD thesis, Cukurova University, 2026."
)


def method_facts(version: str, notes: Sequence[str]) -> dict[str, Any]:
    """Definitions of columns, criteria, statuses and words, citation, and notes."""
    better = {metric.name: metric.better for metric in METRICS}
    return {
        "columns": [
            {
                "name": column.name,
                "unit": column.unit,
                "definition": column.definition,
                "better": better.get(column.name),
            }
            for column in COLUMNS
        ],
        "criteria": criterion_facts(),
        "statuses": [{"name": each.name, "meaning": each.meaning} for each in STATUSES],
        "words": [{"word": word, "meaning": meaning} for word, meaning in WORDS.items()],
        "citation": CITATION.format(version=version),
        "notes": list(notes),
    }


def incompatible(measured: Iterable[str]) -> dict[str, str]:
    """Combinations of the measured methods that cannot run or are meaningless, with the reason.

    Parameters
    ----------
    measured : iterable of str
        All measured combinations, which are excluded.
    """
    names = set(measured)
    kinds = zip(*(name.split("-") for name in names), strict=True)
    methods = installed_methods()
    reasons = {}
    for parts in product(*(sorted(set(kind)) for kind in kinds)):
        combination = Combination(*parts)
        if str(combination) in names:
            continue
        try:
            reason = why_incompatible(combination, methods)
            reason = reason or why_meaningless(combination, methods)
        except SelectionError:
            # A method of a plug-in that is not installed here.
            continue
        if reason:
            reasons[str(combination)] = reason
    return reasons
