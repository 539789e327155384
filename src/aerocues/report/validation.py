"""Results of the validation of a ranking, in the payload."""

from __future__ import annotations

from typing import Any

from aerocues.scoring.agreement import Agreement
from aerocues.scoring.cues import Scores
from aerocues.scoring.sensitivity import Variants
from aerocues.scoring.validation import Validation


def validation_facts(scores: Scores, found: Validation) -> dict[str, Any]:
    """Sensitivity, agreement, correlations, hierarchies, Pareto front, critical difference."""
    return {
        "alpha": _matrix(found.alpha),
        "aggregation": _matrix(found.aggregation),
        "criterion_left_out": _matrix(found.criterion_left_out),
        "agreement": _or_reason(found.agreement, _matrix),
        "criteria_correlation": {
            "names": scores.table.criterion_names,
            "correlation": found.criteria_correlation,
        },
        "hierarchies": {name: frame.to_dicts() for name, frame in found.hierarchies.items()},
        "pareto": {"criteria": found.pareto_criteria, "front": found.pareto_front},
        "rank_reversal": vars(found.rank_reversal) if found.rank_reversal else None,
        "critical_difference": _or_reason(found.critical_difference, vars),
    }


def _matrix(found: Variants | Agreement) -> dict[str, Any]:
    return {"names": found.names, "correlation": found.correlation, "best": found.best}


def _or_reason(found: Any, facts: Any) -> Any:
    return {"unavailable": found} if isinstance(found, str) else facts(found)
