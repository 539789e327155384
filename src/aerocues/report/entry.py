"""One dataset on one machine, with everything that the page shows about it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from aerocues.report.arrays import packed_bytes
from aerocues.report.columns import column_facts, matrix_positions
from aerocues.report.curves import curves_of, step_of
from aerocues.report.models import model_facts
from aerocues.report.preset_scores import preset_scores
from aerocues.report.race import race_facts
from aerocues.report.scores import method_labels, score_facts
from aerocues.report.validation import validation_facts
from aerocues.results.combination_columns import combination_name
from aerocues.results.failures import failures_of
from aerocues.results.medians import combination_medians
from aerocues.results.scaled_times import SCALED
from aerocues.results.statuses import STATUSES
from aerocues.scoring.across import Entry
from aerocues.scoring.combinations import SUCCESS, SUCCESS_WITHOUT_CHANCE_TEST
from aerocues.scoring.ranking import Ranking
from aerocues.scoring.settings import score_preset_named
from aerocues.scoring.validation import Validation

if TYPE_CHECKING:
    import polars as pl

    from aerocues.results.measured_results import Results

NOT_MEASURED = "not measured"
STAGES = ("detect", "describe", "match", "verify", "total")
MOST_FAILURES = 400
LONG = ("combinations", "exclusions")


@dataclass(frozen=True)
class ReportEntry:
    """The content of the report for one dataset on one machine.

    Attributes
    ----------
    entry : Entry
    ranking : Ranking
    validation : Validation
    settings : dict
        As in ``run.json``.
    results : Results
        Where it was read from.
    models : pl.DataFrame
        Its reconstructions; empty if there are none.
    """

    entry: Entry
    ranking: Ranking
    validation: Validation
    settings: dict[str, Any]
    results: Results
    models: pl.DataFrame

    @property
    def name(self) -> str:
        return self.entry.name

    @property
    def rows(self) -> pl.DataFrame:
        """The measured rows."""
        return self.entry.rows

    @property
    def combinations(self) -> tuple[str, ...]:
        """Names of the combinations, in the order of all arrays."""
        return self.ranking.scores.table.alternatives

    @property
    def chance_fails(self) -> bool:
        """Whether a pair that does not beat chance counts as failed."""
        return score_preset_named(self.entry.preset).chance_fails

    @property
    def succeeded(self) -> tuple[str, ...]:
        """Statuses of pairs that count as a success."""
        return SUCCESS if self.chance_fails else SUCCESS_WITHOUT_CHANCE_TEST

    def seconds(self) -> dict[str, float]:
        """Median time of each combination per image and pair, where known."""
        medians = combination_medians(self.rows).drop_nulls("total_seconds")
        return dict(medians.select("combination", "total_seconds").iter_rows())

    def pairs(self) -> list[dict[str, Any]]:
        """The pairs in order: number, sequence, images, and position along a curve."""
        import polars as pl

        named = self.rows.select(
            "pair", pl.col("sequence").fill_null("").cast(pl.String), "image_1", "image_2"
        )
        pairs = named.unique().sort("pair").to_dicts()
        return [{**pair, "step": step_of(self.entry.dataset, pair)} for pair in pairs]


def entry_facts(found: ReportEntry) -> dict[str, Any]:
    """An entry of the payload."""
    entry, rows, pairs = found.entry, found.rows, found.pairs()
    positions = matrix_positions(
        rows,
        {name: position for position, name in enumerate(found.combinations)},
        {pair["pair"]: position for position, pair in enumerate(pairs)},
    )
    shape = (len(found.combinations), len(pairs))
    table = found.ranking.scores.table
    measured = found.settings.get("dataset") or {}
    # In a folder with several datasets, run.json describes the latest run.
    known = measured.get("name") == entry.dataset
    return {
        "name": entry.name,
        "dataset": entry.dataset,
        "machine": entry.machine,
        "preset": entry.preset,
        "timing": _timing(rows),
        "geometry": measured.get("geometry") if known else None,
        "combinations": found.combinations,
        **method_labels(found.combinations),
        "pairs": pairs,
        "curves": curves_of(entry.dataset, pairs),
        **_status_matrix(rows, positions, shape),
        "columns": column_facts(rows, positions, shape, found.succeeded, table.criteria),
        "score": score_facts(found.ranking, found.seconds(), entry.preset),
        "preset_scores": preset_scores(found),
        "megabytes": _megabytes(found),
        "race": race_facts(found.results, entry.dataset),
        "medians": _medians(found),
        "validation": validation_facts(found.ranking.scores, found.validation),
        "models": model_facts(found.rows, found.models, chance_fails=found.chance_fails),
        **_outcomes(rows),
        "excluded": _excluded(found.settings),
        "run": _run(found.settings, pairs) if known else {},
    }


def _run(settings: Mapping[str, Any], pairs: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """The content of ``run.json`` without long lists and local paths.

    It describes the latest run; the folder may also have pairs of earlier runs.
    """
    kept = {name: value for name, value in settings.items() if name not in LONG}
    dataset = dict(kept["dataset"])
    dataset.pop("source", None)
    dataset["pairs"] = len(pairs)
    if dataset.get("images"):
        dataset["images"] = len({pair[name] for pair in pairs for name in ("image_1", "image_2")})
    return {**kept, "dataset": dataset}


def _timing(rows: pl.DataFrame) -> str:
    """Source of the times; ``sampled`` if some pairs were timed alone and scale the others."""
    kinds = set(rows["timing"].to_list())
    if kinds == {None}:
        return "unknown"
    if kinds == {"exclusive", SCALED}:
        return "sampled"
    return str(kinds.pop()) if len(kinds) == 1 else "mixed"


def _status_matrix(rows: pl.DataFrame, positions: Any, shape: tuple[int, int]) -> dict[str, Any]:
    names = [status.name for status in STATUSES]
    names += sorted(set(rows["status"].unique()) - set(names))
    names.append(NOT_MEASURED)
    matrix = np.full(shape, len(names) - 1, dtype=np.uint8)
    matrix[positions] = [names.index(status) for status in rows["status"]]
    return {"statuses": names, "status": packed_bytes(matrix)}


def _medians(found: ReportEntry) -> dict[str, list[float | None]]:
    medians = {row["combination"]: row for row in combination_medians(found.rows).to_dicts()}
    return {
        stage: [medians[name][f"{stage}_seconds"] for name in found.combinations]
        for stage in STAGES
    }


def _megabytes(found: ReportEntry) -> list[float | None]:
    """Descriptors of one image in megabytes, the median over the pairs of each combination."""
    import polars as pl

    name = combination_name()
    bytes_of_image = pl.col("keypoints_1") * pl.col("descriptor_bytes")
    medians = found.rows.group_by(name).agg((bytes_of_image / 1e6).median().alias("megabytes"))
    known = dict(medians.iter_rows())
    return [known.get(each) for each in found.combinations]


def _outcomes(rows: pl.DataFrame) -> dict[str, Any]:
    """Number of rows by status, and of failed rows by status and methods."""
    counts = rows.group_by("status").len().sort("len", "status", descending=[True, False])
    failures = failures_of(rows)
    return {
        "counts": dict(counts.iter_rows()),
        "failures": failures.head(MOST_FAILURES).to_dicts(),
        "failures_left_out": max(len(failures) - MOST_FAILURES, 0),
    }


def _excluded(settings: dict[str, Any]) -> list[dict[str, Any]]:
    """Combinations that could not run on these images, by reason and number of pairs."""
    together: defaultdict[tuple[str, int], list[str]] = defaultdict(list)
    for exclusion in settings.get("exclusions") or []:
        together[exclusion["reason"], exclusion["pairs"]].append(exclusion["combination"])
    return [
        {"reason": reason, "combinations": names, "pairs": pairs}
        for (reason, pairs), names in together.items()
    ]
