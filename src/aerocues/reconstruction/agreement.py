"""Models that agree with each other outvote GPS: a receiver errs, and features do not err alike."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from aerocues.methods.combination import Combination
from aerocues.reconstruction.alignment import (
    extent,
    robust_similarity,
    root_mean_square,
    similarity,
)
from aerocues.reconstruction.protocol import Requirements
from aerocues.reconstruction.truth import GPS, GPS_IN_PLAN
from aerocues.results.clouds import Cloud
from aerocues.results.metrics import Row

Array = NDArray[np.float64]
MODELS = "models"
OK, MISPLACED = "ok", "misplaced"
# What is said of positions by GPS, and is no more where GPS is outvoted.
OUTVOTED = (
    *("position_rmse", "position_median", "position_error_share", "plan_rmse", "height_rmse"),
)


@dataclass(frozen=True)
class Vote:
    """Models that agree with one of them.

    Parameters
    ----------
    of : Combination
        The model in whose frame the others are compared.
    members : tuple of Combination
        Those that agree, itself among them.
    spread : float
        Largest root mean square distance of a member's cameras, as a share of the extent.
    """

    of: Combination
    members: tuple[Combination, ...]
    spread: float


def outvoted(
    rows: Mapping[Combination, Row],
    cloud_of: Callable[[Combination], Cloud | None],
    requirements: Requirements,
) -> dict[Combination, Row]:
    """Rows that no longer hold GPS against models which agree with each other and not with it.

    Parameters
    ----------
    rows : mapping of Combination to Row
    cloud_of : callable
    requirements : Requirements

    Returns
    -------
    dict of Combination to Row
        The same where GPS holds. Else whole models are judged by the place of their cameras among
        those that agree, ``truth`` is ``models``, and what GPS says of positions is gone.
    """
    judged = dict(rows)
    clouds = _clouds(rows, cloud_of, GPS_IN_PLAN)
    if vote := _vote(clouds, requirements):
        told = f"heights of GPS are left out: {_told(vote, clouds[vote.of])}"
        judged |= {each: {**rows[each], "message": told} for each in vote.members}
    clouds = _clouds(rows, cloud_of, GPS)
    vote = _vote(clouds, requirements)
    if vote and _wins(vote, rows, clouds):
        centre = clouds[vote.of]
        told = f"GPS and models disagree: {_told(vote, centre)}"
        for each, cloud in clouds.items():
            judged[each] = _judged_anew(rows[each], cloud, centre, told, requirements)
    return judged


def _clouds(
    rows: Mapping[Combination, Row],
    cloud_of: Callable[[Combination], Cloud | None],
    truth: str,
) -> dict[Combination, Cloud]:
    """Clouds of whole models that were compared with this truth."""
    return {
        each: cloud
        for each, row in rows.items()
        if row["status"] in (OK, MISPLACED)
        and row.get("truth") == truth
        and (cloud := cloud_of(each)) is not None
    }


def _vote(clouds: Mapping[Combination, Cloud], requirements: Requirements) -> Vote | None:
    """The largest group of models that agree with one of them; None where it is too small."""
    spreads: dict[Combination, dict[Combination, float]] = {each: {each: 0.0} for each in clouds}
    for one, other in combinations(sorted(clouds), 2):
        if (spread := _spread(clouds[one], clouds[other], requirements)) is not None:
            spreads[one][other] = spreads[other][one] = spread
    best: Vote | None = None
    for one in sorted(clouds):
        vote = Vote(one, tuple(sorted(spreads[one])), max(spreads[one].values()))
        if best is None or (len(vote.members), -vote.spread) > (len(best.members), -best.spread):
            best = vote
    if best is None or len(best.members) < requirements.voters:
        return None
    return best if len({each.detector for each in best.members}) > 1 else None


def _wins(vote: Vote, rows: Mapping[Combination, Row], clouds: Mapping[Combination, Cloud]) -> bool:
    """Whether more models agree with each other against GPS than there are that GPS confirms."""
    against = [each for each in vote.members if rows[each]["status"] == MISPLACED]
    confirmed = [each for each in clouds if rows[each]["status"] == OK]
    return len(against) > len(confirmed)


def _spread(cloud: Cloud, other: Cloud, requirements: Requirements) -> float | None:
    """How far cameras of two models are apart, as a share of the extent; None: they disagree."""
    size = extent(other.centres.astype(np.float64))
    errors = _distances(cloud, other, requirements.agreement * size)
    if errors is None:
        return None
    near = errors[errors <= requirements.agreement * size]
    if len(near) < requirements.registered_share * max(len(cloud.names), len(other.names)):
        return None
    return root_mean_square(near) / size


def _distances(cloud: Cloud, other: Cloud, tolerance: float) -> Array | None:
    """Distances of the cameras that both models have, in the frame of the other."""
    _, mine, theirs = np.intersect1d(cloud.names, other.names, return_indices=True)
    source, target = (
        each.centres[which].astype(np.float64) for each, which in ((cloud, mine), (other, theirs))
    )
    frame = robust_similarity(source, target, tolerance)
    if frame is None:
        return None
    distances: Array = np.linalg.norm(frame.apply(source) - target, axis=1)
    return distances


def _judged_anew(
    row: Row, cloud: Cloud, centre: Cloud, told: str, requirements: Requirements
) -> Row:
    tolerance = requirements.position_error_share * extent(centre.centres.astype(np.float64))
    distances = _distances(cloud, centre, tolerance)
    placed = 0 if distances is None else int((distances <= tolerance).sum())
    row = {**row, **dict.fromkeys(OUTVOTED), "truth": MODELS, "placed_images": placed}
    if placed >= requirements.registered_share * row["images"]:
        return {**row, "status": OK, "message": told}
    away = len(cloud.names) - placed
    own = f"{away} of {len(cloud.names)} cameras are not where the models that agree have them"
    return {**row, "status": MISPLACED, "message": f"{own}; {told}"}


def _told(vote: Vote, cloud: Cloud) -> str:
    """What is wrong with GPS, by the model in the middle of those that agree."""
    differences = _to_gps(cloud)
    plan = root_mean_square(np.linalg.norm(differences[:, :2], axis=1))
    height = root_mean_square(differences[:, 2])
    steps = np.arange(len(differences))
    drifts = np.polyfit(steps, differences, 1)[0] * (len(differences) - 1)
    return (
        f"{len(vote.members)} models agree among themselves to within {vote.spread:.1%} of the "
        f"extent; GPS is {plan:.1f} m off in plan and {height:.1f} m in height (root mean square) "
        f"and drifts by {np.linalg.norm(drifts[:2]):.1f} m and {abs(drifts[2]):.1f} m in the "
        "course of the flight"
    )


def _to_gps(cloud: Cloud) -> Array:
    """From the cameras to their positions by GPS, in the order of names, (C, 3) metres."""
    positions = cloud.positions.astype(np.float64)
    known = np.flatnonzero(np.isfinite(positions).all(axis=1))
    known = known[np.argsort(cloud.names[known])]
    centres = cloud.centres.astype(np.float64)[known]
    frame = similarity(centres, positions[known])
    differences: Array = positions[known] - (centres if frame is None else frame.apply(centres))
    return differences
