"""Which pairs a run takes where nobody chose them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import Dataset
from aerocues.evaluation.run import plan_run


def planned(dataset: Dataset, output: Path, preset: str = "default") -> int:
    """How many pairs a run would measure."""
    plan = plan_run(dataset, "ORB-ORB-HAM-BF", output, preset=preset, timing="shared")[0][1]
    return len({row.pair for row in plan.rows})


def test_a_flight_is_surveyed_unless_somebody_chose_its_pairs(strips: Path, tmp_path: Path) -> None:
    opened = open_dataset(strips)
    assert planned(opened, tmp_path) > 5
    assert not any(tmp_path.iterdir())
    assert planned(open_dataset(strips, pairs="consecutive"), tmp_path) == 5
    assert planned(open_dataset(strips, max_pairs=2), tmp_path) == 2
    assert planned(opened, tmp_path, "thesis") == 5
    short = replace(opened, images=opened.images[:4], pairs=opened.pairs[:3])
    assert planned(short, tmp_path) == 3
