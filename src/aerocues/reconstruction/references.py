"""Distances of all clouds to the reference cloud."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from aerocues.methods.combination import Combination
from aerocues.reconstruction.cloud_distance import CloudDistances, cloud_distances
from aerocues.results.clouds import Cloud
from aerocues.results.metrics import Row
from aerocues.results.model_quality import model_order


def with_distances(
    rows: Mapping[Combination, Row],
    cloud_of: Callable[[Combination], Cloud | None],
    reference: Combination | None,
) -> tuple[list[Row], dict[str, Cloud]]:
    """Rows and clouds with their distances to the reference.

    Parameters
    ----------
    rows : mapping of Combination to Row
    cloud_of : callable
    reference : Combination, optional
        By default the best successful model; see `model_quality`.

    Returns
    -------
    rows : list of Row
        In the same order.
    clouds : dict of str to Cloud
        By the key of the row.
    """
    clouds = {
        each: cloud
        for each, row in rows.items()
        if row.get("registered_images") and (cloud := cloud_of(each)) is not None
    }
    chosen = _reference(rows, clouds, reference)
    measured_rows, measured_clouds = [], {}
    for combination, row in rows.items():
        cloud = clouds.get(combination)
        if cloud is not None:
            figures: Row = {}
            found = _distances(combination, chosen, clouds)
            if chosen is not None and found is not None:
                unit = clouds[chosen].unit
                figures = {**found.figures(), "reference": str(chosen), "length_unit": unit}
                cloud = cloud.with_distances(found.to_reference)
            row = {**row, **figures}  # noqa: PLW2901
            measured_clouds[str(row["row_key"])] = cloud
        measured_rows.append(row)
    return measured_rows, measured_clouds


def _distances(
    combination: Combination, reference: Combination | None, clouds: Mapping[Combination, Cloud]
) -> CloudDistances | None:
    if reference is None:
        return None
    if combination == reference:  # exactly, regardless of rounding in an alignment
        nothing = np.zeros(len(clouds[reference].points))
        return CloudDistances(nothing, nothing)
    return cloud_distances(clouds[combination], clouds[reference])


def _reference(
    rows: Mapping[Combination, Row],
    clouds: Mapping[Combination, Cloud],
    wanted: Combination | None,
) -> Combination | None:
    if wanted is not None:
        return wanted if wanted in clouds else None
    good = [each for each in clouds if rows[each]["status"] == "ok"]
    return min(good, key=lambda each: (model_order(rows[each]), str(each)), default=None)
