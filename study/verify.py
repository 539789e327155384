"""Measure a random share of the database again, and compare quality to the last digit."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import aerocues
from aerocues.datasets.dataset import Dataset, Pair
from aerocues.errors import DatasetError
from aerocues.phrases import count
from aerocues.results.combination_columns import METHODS, combination_name
from aerocues.results.metrics import METRICS
from aerocues.results.schema import COUNTS, GROUND_TRUTH, OUTCOME, REFERENCE
from aerocues.results.study import FACTS, add_part
from study.plan import UNFINISHED, Step

if TYPE_CHECKING:
    import polars as pl

    from study.measuring import Study

SHARE = 0.05
SHOWN = 5
PAIR = ("pair", "image_1", "image_2", "sequence")
QUALITY = (
    *(column.name for column in (*OUTCOME, *COUNTS, *REFERENCE, *GROUND_TRUTH)),
    *(metric.name for metric in METRICS if "seconds" not in metric.name),
)
"""Columns that no clock has to do with."""


def verify(study: Study, parts: Sequence[str], seed: int) -> int:
    """Measure 5 % of the rows of each part again, and note it.

    The seed draws the rows: the same ones for the same seed and database. Returns 0 if all are
    identical, 1 if not, `UNFINISHED` if a part was skipped, as images or modules are missing.
    """
    database = aerocues.Study(study.database)
    first = {step.part.name: step for step in reversed(study.plan.of(parts))}
    total = different = skipped = 0
    for name in (name for name in first if name in database.names):
        rows = database.part(name).table()
        sample = rows.sample(fraction=SHARE, seed=seed) if len(rows) > 1 / SHARE else rows.head(1)
        try:
            again = _measured_again(study, first[name], sample)
        except DatasetError as error:
            study.tell(f"{name}: skipped: {error}")
            skipped += 1
            continue
        unequal = differing(sample, again)
        total, different = total + len(sample), different + len(unequal)
        same = {"again": len(sample), "identical": len(sample) - len(unequal)}
        facts = {**database.part(name).settings[FACTS], "verified": same}
        add_part(study.database, name, study.database / name, facts)
        study.tell(f"{name}: {count(len(sample), 'row')} measured again, {len(unequal)} different")
        for line in unequal.head(SHOWN).iter_rows():
            study.tell(f"  {' '.join(map(str, line))}")
    study.tell(f"all: {count(total, 'row')} measured again, {total - different:,} identical")
    return 1 if different else UNFINISHED if skipped else 0


def differing(stored: pl.DataFrame, again: pl.DataFrame) -> pl.DataFrame:
    """The pair and combination of stored rows that are missing or different in other rows."""
    keys, names = ("pair", *METHODS), list(QUALITY)
    found = again.select(*keys, *names)
    same = stored.select(*keys, *names).join(
        found, on=[*keys, *names], nulls_equal=True, how="anti"
    )
    return same.select("pair", combination_name())


def _measured_again(study: Study, step: Step, sample: pl.DataFrame) -> pl.DataFrame:
    """The rows of a sample, measured in a new folder of their own, pair by pair."""
    if missing := step.missing():
        raise DatasetError(f"{', '.join(missing)} is not installed")
    dataset = study.dataset(step)
    study.work.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=study.work, prefix="verify-") as folder:
        _measure_again(study, dataset, step, sample, Path(folder))
        return aerocues.Results(folder).table()


def _measure_again(
    study: Study, dataset: Dataset, step: Step, sample: pl.DataFrame, folder: Path
) -> None:
    timed = ("timing", "timing_pairs")
    settings = {k: v for k, v in step.part.settings.items() if k not in timed}
    for named, rows in sample.group_by(PAIR, maintain_order=True):
        number, image_1, image_2, sequence = named
        known = {(pair.image_1, pair.image_2): pair.homography for pair in dataset.pairs}
        pair = Pair(number, image_1, image_2, sequence, known.get((image_1, image_2)))
        aerocues.run(
            _of_pair(dataset, pair),
            rows.select(combination_name()).to_series().to_list(),
            folder,
            **{**settings, "timing": "estimated"},
            workers=study.workers,
            progress=study.watch,
        )


def _of_pair(dataset: Dataset, pair: Pair) -> Dataset:
    images = [image for image in dataset.images if image.name in (pair.image_1, pair.image_2)]
    return replace(dataset, images=images, pairs=[pair])
