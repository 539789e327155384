"""Correlations of pairs and 3D models in the output of `aerocues validate`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from aerocues.cli.console import plain_table, print_table, standard_output
from aerocues.cli.validation_tables import print_title

if TYPE_CHECKING:
    import polars as pl

    from aerocues.scoring.measured import Measured
    from aerocues.scoring.outcomes import Relations

HEADINGS = {
    "registered_images": "images",
    "points_3d": "points",
    "observations": "observ.",
    "mean_track_length": "track",
    "reprojection_error": "error",
    "position_rmse": "position",
    "rotation_error": "rotation",
    "surface_error": "surface",
    "cloud_distance_rms": "C2C",
    "reference_distance_rms": "C2C back",
    "reconstruction_seconds": "seconds",
}


def found_relations(results: Measured, preset: str | None, dataset: str | None) -> Relations | str:
    """The relations, or why there are none."""
    from aerocues.cli.wording import in_options
    from aerocues.errors import ScoreError
    from aerocues.scoring.outcomes import relate_outcomes

    try:
        return relate_outcomes(results, preset, dataset=dataset)
    except ScoreError as error:
        return in_options(str(error))


def print_relations(found: Relations | str) -> None:
    """Print Spearman's correlations of figures of pairs with outcomes of reconstructions."""
    console = standard_output()
    if isinstance(found, str):
        print_title(console, "\n3D models")
        console.print(found, markup=False)
        return
    shown = found.spearman == found.spearman
    numbers = sorted({int(number) for number in found.numbers[shown]})
    over = f"{numbers[0]}" if len(numbers) == 1 else f"{numbers[0]} to {numbers[-1]}"
    title = f"\n3D models: Spearman's correlation with figures of pairs, over {over}"
    print_title(console, f"{title} combinations")
    headings = [HEADINGS.get(name, name) for name in found.outcomes]
    output = plain_table("", *headings, numbers=len(headings), gap=1)
    output.columns[0].no_wrap = True
    for name, values in zip(found.features, found.spearman, strict=True):
        output.add_row(name, *(f"{value:.2f}" if value == value else "-" for value in values))
    print_table(console, output)
    console.print(
        "Figures of models count for successful reconstructions, images for all. The report also "
        "shows Pearson's correlation."
    )


def relations_table(found: Relations) -> pl.DataFrame:
    """The same for files; the first column names the rows, as ``FEATURE -> OUTCOME``."""
    import polars as pl

    name = pl.concat_str("feature", "outcome", separator=" -> ").alias("name")
    return found.frame().select(name, pl.exclude("feature", "outcome"))


def relation_facts(found: Relations | str) -> Any:
    """The same for JSON."""
    return found if isinstance(found, str) else found.frame().to_dicts()
