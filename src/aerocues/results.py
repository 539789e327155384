"""Measured results with all that can be done with them, for users of the library."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, ParamSpec

from aerocues.evaluation import results as measured

Parameters = ParamSpec("Parameters")


class Results(measured.Results):
    """The rows of a results folder.

    Parameters
    ----------
    folder : path
        The folder, or the file that `pack` made of it.

    Raises
    ------
    StoreError
        If `folder` is no results folder and no packed one.
    """

    def report(self, output: str | Path = "report.html", **options: Any) -> Path:
        """Write a report on these results; the options are those of `aerocues.write_report`."""
        from aerocues.report.report import write_report

        return write_report([self], output, **options)


def giving_results(
    function: Callable[Parameters, measured.Results],
) -> Callable[Parameters, Results]:
    """The same function with `Results` that can report."""
    from functools import wraps

    @wraps(function)
    def call(*args: Parameters.args, **kwargs: Parameters.kwargs) -> Results:
        return Results(function(*args, **kwargs).folder)

    return call
