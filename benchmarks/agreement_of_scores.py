"""How far the score by the reference agrees with the score by ground truth.

    python benchmarks/agreement_of_scores.py WORK

On the pairs of `agreement.py` (and in its folder): the score of the preset `default`, once as it
is and once with ground truth in place of the reference (precision, matching score, repeatability,
numbers of right matches, links; coverage alone stays). Prints for each dataset Spearman's
correlation of the two over the combinations, both winners, and what the first loses by the second
score. Interrupted, it goes on. Takes about 15 minutes of one core.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import cv2
import polars as pl
from agreement import datasets, measured
from scipy.stats import spearmanr

from aerocues.results.schema import PIXEL_THRESHOLDS
from aerocues.scoring.cues import score
from aerocues.scoring.measured import table_of


@dataclass(frozen=True)
class Rows:
    """Measured rows, as `table_of` takes them."""

    rows: pl.DataFrame

    def table(self) -> pl.DataFrame:
        return self.rows

    def reconstructions(self) -> pl.DataFrame:
        return pl.DataFrame(schema={"dataset": pl.String})


def by_truth(rows: pl.DataFrame) -> pl.DataFrame:
    """The rows with ground truth under the names of the reference."""
    names = [f"{kind}@{t}" for kind in ("precision", "matching_score") for t in PIXEL_THRESHOLDS]
    names.append("repeatability")
    return rows.with_columns(
        *(pl.col(f"gt_{name}").alias(f"ref_{name}") for name in names),
        *(
            (pl.col(f"gt_precision@{t}") * pl.col("matches")).alias(f"ref_matches@{t}")
            for t in (1, 3)
        ),
    )


def scored(rows: pl.DataFrame) -> dict[str, float]:
    """Scores by combination."""
    arranged = table_of(Rows(rows), "default", reconstruction=False)
    found = score(arranged.table, arranged.preset.settings)
    return dict(zip(found.table.alternatives, map(float, found.scores), strict=True))


def line(dataset: str, rows: pl.DataFrame) -> dict[str, object]:
    """What the two scores say of a dataset."""
    of_reference, of_truth = scored(rows), scored(by_truth(rows))
    names = sorted(of_reference)
    chosen, best = (max(names, key=each.__getitem__) for each in (of_reference, of_truth))
    return {
        "dataset": dataset,
        "combinations": len(names),
        "pairs": rows["pair"].n_unique(),
        "Spearman": spearmanr(
            [of_reference[name] for name in names], [of_truth[name] for name in names]
        ).statistic,
        "by reference": chosen,
        "by truth": best,
        "lost": of_truth[best] - of_truth[chosen],
    }


def main() -> None:
    """Measure and print."""
    work = Path(sys.argv[1])
    work.mkdir(parents=True, exist_ok=True)
    cv2.setNumThreads(1)
    lines = []
    for dataset in datasets(work):
        rows = measured(dataset, work)
        own = rows.filter((pl.col("reference") == "flow") & pl.col("gt_precision@3").is_not_null())
        kept = rows.filter(pl.col("pair").is_in(own["pair"].unique().to_list()))
        lines.append(line(dataset.name, kept))
        lines += [
            line(f"{dataset.name}, {sequence}", part)
            for (sequence,), part in kept.partition_by("sequence", as_dict=True).items()
            if dataset.name in ("oxford", "hpatches")
        ]
        print(lines[-1], flush=True)
    with pl.Config(tbl_rows=-1, tbl_cols=-1, tbl_formatting="MARKDOWN", float_precision=3):
        print(pl.DataFrame(lines))


if __name__ == "__main__":
    main()
