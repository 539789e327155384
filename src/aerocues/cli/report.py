"""`aerocues report`: one page with all results."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from aerocues.cli.options import NoPluginsOption, PluginOption, ResultsArguments
from aerocues.cli.scoring import (
    AggregationOption,
    AlphaOption,
    CriteriaOption,
    FailuresOption,
    PresetOption,
    ReconstructionOption,
    SeedOption,
    WeightsOption,
)
from aerocues.defaults import MEGABYTES, PICTURED, RESAMPLES

if TYPE_CHECKING:
    from aerocues.progress import Event
    from aerocues.report.entry import ReportEntry

STANDARD_OUTPUT = "-"
PAGE = Path("report.html")


class Format(StrEnum):
    """Values of ``--format``."""

    HTML = "html"
    MARKDOWN = "markdown"


def report(
    results: ResultsArguments,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FILE",
            help="Page to write; by default report.html. Markdown goes to standard output.",
        ),
    ] = None,
    form: Annotated[
        Format, typer.Option("--format", help="A page (html), or a short text (markdown).")
    ] = Format.HTML,
    title: Annotated[str | None, typer.Option(metavar="TEXT", help="Title of the page.")] = None,
    show: Annotated[bool, typer.Option("--open", help="Open the page in a browser.")] = False,
    figures: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Write figures for a paper to this folder, as SVG and PDF."
        ),
    ] = None,
    images: Annotated[
        list[str] | None,
        typer.Option(metavar="DATASET", help="New place of moved images, such as oxford:DIR."),
    ] = None,
    pictures: Annotated[
        int,
        typer.Option(min=0, metavar="N", help="Number of combinations with pictures, per dataset."),
    ] = PICTURED,
    max_megabytes: Annotated[
        float,
        typer.Option(
            min=2,
            metavar="MB",
            help="Size limit of the page: pictures and clouds beyond it are left out.",
        ),
    ] = MEGABYTES,
    preset: PresetOption = None,
    criteria: CriteriaOption = None,
    failures: FailuresOption = None,
    alpha: AlphaOption = None,
    weights: WeightsOption = None,
    aggregation: AggregationOption = None,
    reconstruction: ReconstructionOption = None,
    resamples: Annotated[
        int, typer.Option(min=2, metavar="N", help="Number of bootstrap resamples.")
    ] = RESAMPLES,
    seed: SeedOption = 0,
    plugin: PluginOption = None,
    no_plugins: NoPluginsOption = False,
) -> None:
    """Write all results into one interactive page.

    The page needs no network. Several results (datasets or machines) are shown side by side.
    """
    import aerocues
    from aerocues.cli.interruption import interruptible
    from aerocues.report.report import report_entries, write_page

    with interruptible():
        entries = report_entries(
            [aerocues.Results(each) for each in results],
            preset,
            criteria=criteria,
            reconstruction=reconstruction,
            resamples=resamples,
            seed=seed,
            progress=_tell,
            failures=failures.value if failures else None,
            alpha=alpha,
            weights=weights,
            aggregation=aggregation,
        )
        if figures is not None:
            _write_figures(entries, figures)
            if output is None and form is Format.HTML:
                return
        if form is Format.MARKDOWN:
            _write_markdown(entries, title, output)
            return
        page = write_page(
            entries,
            output or PAGE,
            title=title,
            images=images or (),
            pictures=pictures,
            max_megabytes=max_megabytes,
            progress=_tell,
        )
    typer.echo(f"{page} ({page.stat().st_size / 1e6:.1f} MB)")
    if show:
        typer.launch(str(page))


def _tell(event: Event) -> None:
    """Say what is being done, where somebody may be waiting."""
    from aerocues.cli.wording import in_options

    if sys.stderr.isatty():
        sys.stderr.write(f"{in_options(event.message)}\n")


def _write_figures(entries: list[ReportEntry], folder: Path) -> None:
    from aerocues.phrases import count
    from aerocues.report.figures import write_figures

    files = write_figures(entries, folder)
    sys.stderr.write(f"{count(len(files), 'figure file')} written to {folder}\n")


def _write_markdown(entries: list[ReportEntry], title: str | None, output: Path | None) -> None:
    from aerocues.report.markdown import summary
    from aerocues.report.report import default_title
    from aerocues.results.export import write_file

    text = summary(entries, title or default_title(entries))
    if output is None or str(output) == STANDARD_OUTPUT:
        typer.echo(text, nl=False)
    else:
        write_file(output, text.encode())
        typer.echo(output)
