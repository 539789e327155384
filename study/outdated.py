"""Rows of a part that were measured with other parameters than its preset has by now."""

from __future__ import annotations

import json
from pathlib import Path

import polars as pl

import aerocues
from aerocues.methods.combination import Combination
from aerocues.methods.plugins import installed_methods
from aerocues.methods.registry import Methods
from aerocues.methods.strongest import keypoint_limit
from aerocues.results.combination_columns import name_in_row
from aerocues.results.store import Store
from study.plan import Part


def drop_outdated(folder: Path, part: Part) -> int:
    """Take rows with outdated parameters out of the plan of a results folder; how many.

    Otherwise they would stand beside new ones until each round was measured again.
    """
    outdated = outdated_rows(aerocues.Results(folder).table(), part)
    if outdated:
        store = Store.open(folder)
        with store.writing():
            store.leave_out(outdated)
    return len(outdated)


def outdated_rows(rows: pl.DataFrame, part: Part) -> frozenset[str]:
    """Keys of the rows of a part with outdated parameters; methods must be installed to tell."""
    limit = keypoint_limit(part.run.get("max_keypoints", 0))
    methods = limit.limited(installed_methods().with_preset(part.preset))
    own = rows.filter(pl.col("preset") == part.preset.name)
    now = {name: _parameters(methods, name) for name in map(name_in_row, own.iter_rows(named=True))}
    return frozenset(
        row["row_key"]
        for row in own.iter_rows(named=True)
        if row["parameters"] != (now[name_in_row(row)] or row["parameters"])
    )


def _parameters(methods: Methods, name: str) -> str:
    """What a row would record; empty if a method is not installed."""
    combination = Combination.parse(name)
    known = (methods.detectors, methods.descriptors, methods.matchers)
    own = (combination.detector, combination.descriptor, combination.matcher)
    if not all(each in table for each, table in zip(own, known, strict=True)):
        return ""
    return json.dumps(methods.parameters(combination), sort_keys=True)
