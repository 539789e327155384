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
    """Score and validate every data set in some results, each machine by itself.

    Parameters
    ----------
    results : sequence of Results
        One or more.
    preset, criteria
        See `aerocues.score`.
    reconstruction : bool, optional
        Whether to add the criteria of reconstruction; by default, where there are results of one
        data set only and most combinations were reconstructed.
    resamples, seed
        Of the intervals.
    progress : callable, optional
        Called with each `aerocues.Event`, whose message says what is being done.
    **changes
        Of the preset's settings: ``alpha, weights, aggregation, failures``; None changes nothing.

    Raises
    ------
    ScoreError
        If one of them cannot be scored, or they suit different presets and none was chosen.
    """
    import polars as pl

    if not results:
        raise ScoreError("there are no results to report on; name a results folder")
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
    """The data sets by name."""
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
    """Write one page that shows everything, for a browser; it needs no network.

    Parameters
    ----------
    results : Results, path, or sequence of them
        Of one or several datasets and machines.
    output : path
        An HTML file; one that is there is replaced.
    title : str, optional
    preset, criteria, reconstruction, failures, alpha, weights, aggregation, resamples, seed
        How to score; see `aerocues.score`.
    images : sequence of str
        Where the images of data sets are that have moved, in the form of `open_dataset`.
    pictures : int
        How many combinations of each data set to show pictures of; 0 for none.
    max_megabytes : float
        Clouds and pictures are left out until the page is no larger than this.
    progress : callable, optional
        Called with each `aerocues.Event`, whose message says what is being done.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    AerocuesError
        If the results cannot be scored or the file not be written.
    """
    check_whole("pictures", pictures, 0)
    check_number("max_megabytes", max_megabytes, 5)
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
    """Write the page of entries that are scored; see `write_report`."""
    from aerocues.datasets.catalog import open_dataset
    from aerocues.report.clouds import clouds_of
    from aerocues.report.page import page_of
    from aerocues.report.payload import payload_of
    from aerocues.report.pictures import pictures_of
    from aerocues.report.size import fitting, fitting_clouds, size_of

    told = StageProgress(progress, "reporting").say
    folder = output.expanduser().parent
    if not folder.is_dir():  # told before the pictures, which take long
        raise StoreError(
            f"cannot write {output}: there is no folder {folder}; make it or give another file"
        )
    for spec in images:
        open_dataset(spec)  # a wrong one is a mistake to be told, not a reason for no pictures
    found = [pictures_of(entry, pictures, images, told) for entry in entries if pictures]
    told(f"writing {output}")
    heading = title or default_title(entries)
    page = page_of(payload_of(entries, heading)).encode()
    room = int(max_megabytes * 1e6) - len(page)
    # Where there are pictures, too, clouds take half of the room at most.
    share = room // 2 if any(each.pictures for each in found) else room
    clouds = fitting_clouds([clouds_of(entry) for entry in entries], share)
    kept = fitting(found, room - sum(map(size_of, clouds.clouds)))
    notes = [*clouds.notes, *kept.notes]
    if clouds.clouds or kept.pictures or notes:
        payload = payload_of(entries, heading, pictures=kept, clouds=clouds)
        page = page_of(payload).encode()
    write_file(output, page)
    for note in notes:
        told(note)
    return output
