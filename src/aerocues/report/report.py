"""The report: from results folders to one page, figures or a short text."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from aerocues.arguments import check_number, check_whole
from aerocues.defaults import MEGABYTES, PICTURED, RESAMPLES
from aerocues.errors import ScoreError, StoreError
from aerocues.progress import Progress, StageProgress
from aerocues.report.entry import ReportEntry
from aerocues.results.export import write_file
from aerocues.results.measured_results import Results, as_results
from aerocues.scoring.across import entries_of
from aerocues.scoring.ranking import rank_alternatives
from aerocues.scoring.settings import Failures, Names
from aerocues.scoring.validation import validate


def report_entries(
    results: Sequence[Results],
    preset: str | None = None,
    *,
    criteria: Names | None = None,
    reconstruction: bool | None = None,
    resamples: int = RESAMPLES,
    seed: int = 0,
    progress: Progress | None = None,
    **changes: object,
) -> list[ReportEntry]:
    """Score and validate every dataset in the results, separately for each machine.

    Parameters
    ----------
    results : sequence of Results
        One or more.
    preset, criteria
        See `aerocues.score`.
    reconstruction : bool, optional
        Whether to add the criteria of reconstruction. By default they are added if the results have
        one dataset and most combinations were reconstructed.
    resamples, seed
        Settings of the intervals.
    progress : callable, optional
        Called with each `aerocues.Event`, whose message describes the step.
    **changes
        Settings in place of the preset's: ``alpha, weights, aggregation, failures``. None keeps
        those of the preset.

    Raises
    ------
    ScoreError
        If results cannot be scored, or if they need different presets and none was chosen.
    """
    import polars as pl

    if not results:
        raise ScoreError("no results were given; name a results folder")
    told = StageProgress(progress, "reporting").say
    told("reading and scoring")
    entries = entries_of(
        results, preset, criteria=criteria, reconstruction=reconstruction, **changes
    )
    if not entries:
        raise ScoreError("there are no measured rows; measure some with `aerocues.run`")
    found = []
    for entry in entries:
        source = results[entry.source]
        told(f"scoring {entry.name}")
        scores = entry.scores
        ranking = rank_alternatives(scores.table, scores.settings, resamples=resamples, seed=seed)
        told(f"validating {entry.name}")
        models = source.reconstructions().filter(pl.col("dataset") == entry.dataset)
        validation = validate(scores, seed=seed)
        found.append(ReportEntry(entry, ranking, validation, source.settings, source, models))
    return found


def listed(results: Results | str | Path | Sequence[Results | str | Path]) -> list[Results]:
    """Results one by one, opened."""
    if isinstance(results, Results | str | Path):
        return [as_results(results)]
    return [as_results(each) for each in results]


def default_title(entries: Sequence[ReportEntry]) -> str:
    """A title with the names of the datasets."""
    names = ", ".join(dict.fromkeys(found.name for found in entries))
    return f"Local features on {names}"


def write_report(
    results: Results | str | Path | Sequence[Results | str | Path],
    output: str | Path = "report.html",
    *,
    title: str | None = None,
    preset: str | None = None,
    criteria: Names | None = None,
    reconstruction: bool | None = None,
    failures: Failures | None = None,
    alpha: float | None = None,
    weights: Names | None = None,
    aggregation: str | None = None,
    images: Sequence[str] = (),
    pictures: int = PICTURED,
    max_megabytes: float = MEGABYTES,
    resamples: int = RESAMPLES,
    seed: int = 0,
    progress: Progress | None = None,
) -> Path:
    """Write everything into one HTML page, which needs no network.

    Parameters
    ----------
    results : Results, path, or sequence of them
        Results of one or several datasets and machines.
    output : path
        HTML file; an existing file is replaced.
    title : str, optional
    preset, criteria, reconstruction, failures, alpha, weights, aggregation, resamples, seed
        How to score; see `aerocues.score`.
    images : sequence of str
        New locations of images that have moved, in the form of `open_dataset`.
    pictures : int
        Number of combinations per dataset with pictures; 0 for none.
    max_megabytes : float
        Clouds and pictures are left out until the page is at most this large.
    progress : callable, optional
        Called with each `aerocues.Event`, whose message describes the step.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    AerocuesError
        If the results cannot be scored or the file cannot be written.
    """
    check_whole("pictures", pictures, 0)
    check_number("max_megabytes", max_megabytes, 2)
    entries = report_entries(
        listed(results),
        preset,
        criteria=criteria,
        reconstruction=reconstruction,
        resamples=resamples,
        seed=seed,
        progress=progress,
        failures=failures,
        alpha=alpha,
        weights=weights,
        aggregation=aggregation,
    )
    return write_page(
        entries,
        Path(output),
        title=title,
        images=images,
        pictures=pictures,
        max_megabytes=max_megabytes,
        progress=progress,
    )


def write_page(
    entries: Sequence[ReportEntry],
    output: Path,
    *,
    title: str | None = None,
    images: Sequence[str] = (),
    pictures: int = PICTURED,
    max_megabytes: float = MEGABYTES,
    progress: Progress | None = None,
) -> Path:
    """Write the page of scored entries; see `write_report`."""
    from aerocues.datasets.catalog import open_dataset
    from aerocues.report.clouds import clouds_of
    from aerocues.report.flight_map import flight_map
    from aerocues.report.page import page_of
    from aerocues.report.payload import payload_of
    from aerocues.report.pictures import pictures_of
    from aerocues.report.size import fitting, fitting_clouds, size_of

    told = StageProgress(progress, "reporting").say
    folder = output.expanduser().parent
    if not folder.is_dir():  # reported before the pictures, which take long
        raise StoreError(
            f"cannot write {output}: the folder {folder} does not exist; create it or "
            "give another file"
        )
    for spec in images:
        open_dataset(spec)  # a wrong location is an error, not just a reason for missing pictures
    found = [pictures_of(entry, pictures, images, told) for entry in entries if pictures]
    told(f"writing {output}")
    heading = title or default_title(entries)
    maps = [flight_map(entry, images) for entry in entries if pictures]
    page = page_of(payload_of(entries, heading, maps=maps)).encode()
    room = int(max_megabytes * 1e6) - len(page)
    # If there are pictures, clouds take at most half of the room.
    share = room // 2 if any(each.pictures for each in found) else room
    clouds = fitting_clouds([clouds_of(entry) for entry in entries], share)
    kept = fitting(found, room - sum(map(size_of, clouds.clouds)))
    notes = [*clouds.notes, *kept.notes]
    if clouds.clouds or kept.pictures or notes:
        payload = payload_of(entries, heading, pictures=kept, clouds=clouds, maps=maps)
        page = page_of(payload).encode()
    write_file(output, page)
    for note in notes:
        told(note)
    return output
