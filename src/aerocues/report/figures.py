"""The key figures as vector files for a paper."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aerocues.errors import MethodUnavailableError, StoreError
from aerocues.report.entry import ReportEntry
from aerocues.report.matrix_figures import (
    draw_criteria,
    draw_platforms,
    draw_sensitivity,
    draw_stability,
)
from aerocues.report.model_figures import draw_models, draw_relation
from aerocues.report.relation_figures import draw_critical_difference, draw_pareto, draw_times
from aerocues.report.score_figures import draw_heat_maps, draw_scores, draw_weights
from aerocues.results.export import write_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Each returns None if the data for the figure are missing.
FIGURES: Mapping[str, Callable[[ReportEntry], Figure | None]] = {
    "cues": draw_scores,
    "heat-maps": draw_heat_maps,
    "weights": draw_weights,
    "pareto": draw_pareto,
    "times": draw_times,
    "critical-difference": draw_critical_difference,
    "criteria": draw_criteria,
    "sensitivity": draw_sensitivity,
    "models": draw_models,
    "models-relation": draw_relation,
}
# Of all entries together.
ACROSS: Mapping[str, Callable[[Sequence[ReportEntry]], Figure | None]] = {
    "stability": draw_stability,
    "platforms": draw_platforms,
}
FORMS: Mapping[str, Mapping[str, Any]] = {
    # Without the date the same data always give the same file.
    "svg": {"metadata": {"Date": None}},
    "pdf": {"metadata": {"CreationDate": None}},
}
STYLE: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.size": 8,
    "axes.titlesize": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": False,
    "grid.color": "#d9d9d9",
    "grid.linewidth": 0.5,
    "hatch.linewidth": 0.4,
    "legend.frameon": False,
    "pdf.fonttype": 42,
    "savefig.bbox": "tight",
    "svg.hashsalt": "aerocues",
    # Names of datasets are not formulas.
    "text.parse_math": False,
}
ODD = re.compile(r"[^\w.]+")


def write_figures(entries: Sequence[ReportEntry], folder: str | Path) -> list[Path]:
    """Draw the key figures of each entry and of all together, as SVG and PDF.

    Parameters
    ----------
    entries : sequence of ReportEntry
    folder : path
        Created if it does not exist; files with the same names are replaced.

    Returns
    -------
    list of Path
        The files ``FIGURE.svg`` and ``FIGURE.pdf``; with several entries the name of the entry is
        prefixed to its own.

    Raises
    ------
    MethodUnavailableError
        If matplotlib is not installed.
    StoreError
        If the folder is not writable.
    """
    try:
        from matplotlib import rc_context
    except ImportError as error:
        raise MethodUnavailableError(
            f"figures need matplotlib ({error}); install aerocues[figures]"
        ) from error
    target = Path(folder)
    try:
        target.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StoreError(
            f"cannot make the folder {target}: {error.strerror}; give another folder as `figures`"
        ) from error
    written: list[Path] = []
    with rc_context(STYLE):
        for prefix, found in zip(_prefixes(entries), entries, strict=True):
            for name, draw in FIGURES.items():
                figure = draw(found)
                if figure is not None:
                    written += _write(figure, target / f"{prefix}{name}")
        for name, draw_all in ACROSS.items():
            figure = draw_all(entries)
            if figure is not None:
                written += _write(figure, target / name)
    return written


def _write(figure: Figure, place: Path) -> list[Path]:
    files = []
    for form, options in FORMS.items():
        content = BytesIO()
        figure.savefig(content, format=form, **options)
        file = place.with_name(f"{place.name}.{form}")
        write_file(file, content.getvalue())
        files.append(file)
    return files


def _prefixes(entries: Sequence[ReportEntry]) -> list[str]:
    """Prefix of the file names of each entry; empty for a single entry."""
    if len(entries) == 1:
        return [""]
    names = [ODD.sub("-", found.name).strip("-.") or "entry" for found in entries]
    unique = len({name.casefold() for name in names}) == len(names)
    return [
        f"{name}-" if unique else f"{number}-{name}-" for number, name in enumerate(names, start=1)
    ]
