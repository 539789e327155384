"""Tables for people: Markdown, and LaTeX with booktabs."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import polars as pl

DIGITS = 4
LATEX = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "_": r"\_",
    "%": r"\%",
    "&": r"\&",
    "#": r"\#",
    "$": r"\$",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "|": r"\textbar{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
}
LATEX_SPECIAL = re.compile("|".join(map(re.escape, LATEX)))
POWER = re.compile(r"(-?[\d.]+)e([+-]\d+)")


def as_markdown(table: pl.DataFrame) -> str:
    """A table in GitHub's Markdown; missing values are blank."""
    cells = _cells(table, _markdown_text, plain_number)
    rules = ["---:" if column.dtype.is_numeric() else "---" for column in table.iter_columns()]
    lines = [[_markdown_text(name) for name in table.columns], rules, *cells]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def as_latex(table: pl.DataFrame) -> str:
    """A ``tabular`` with the rules of booktabs; missing values are a dash."""
    columns = "".join("r" if c.dtype.is_numeric() else "l" for c in table.iter_columns())
    head = " & ".join(map(_latex_text, table.columns))
    body = [" & ".join(line) for line in _cells(table, _latex_text, _latex_number)]
    return "\n".join(
        [
            r"% needs \usepackage{booktabs}",
            rf"\begin{{tabular}}{{{columns}}}",
            r"\toprule",
            rf"{head} \\",
            r"\midrule",
            *(rf"{line} \\" for line in body),
            r"\bottomrule",
            r"\end{tabular}",
            "",
        ]
    )


def tables_as_markdown(tables: Mapping[str, pl.DataFrame]) -> str:
    """Several tables, each under its title."""
    return "\n".join(
        f"**{_markdown_text(title)}**\n\n{as_markdown(table)}" for title, table in tables.items()
    )


def tables_as_latex(tables: Mapping[str, pl.DataFrame]) -> str:
    """Several tables, each as a float with its title as the caption."""
    return "\n".join(
        "\n".join(
            [
                r"\begin{table}",
                r"\centering",
                rf"\caption{{{_latex_text(title)}}}",
                f"{as_latex(table)}\\end{{table}}\n",
            ]
        )
        for title, table in tables.items()
    )


def tables_in_long_form(tables: Mapping[str, pl.DataFrame]) -> pl.DataFrame:
    """Several tables as one: ``table, row, column, value``; the first column names the rows."""
    import polars as pl

    found = [
        table.select(
            pl.lit(title).alias("table"),
            pl.col(table.columns[0]).cast(pl.String).alias("row"),
            pl.lit(name).alias("column"),
            pl.col(name).cast(pl.String).alias("value"),
        )
        for title, table in tables.items()
        for name in table.columns[1:]
    ]
    return pl.concat(found)


def plain_number(value: float | None) -> str:
    """A number with four digits; integers are unchanged, and NaN becomes empty.

    >>> [plain_number(value) for value in (0.88214, 12.0, 31415.9, 7, 0.00001234)]
    ['0.8821', '12.00', '31416', '7', '1.234e-05']
    """
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    if isinstance(value, int) or math.isinf(value):
        return str(value)
    if abs(value) >= 10 ** (DIGITS - 1):
        return f"{value:.0f}"
    return f"{value:#.{DIGITS}g}".removesuffix(".") if value else "0"


def _cells(
    table: pl.DataFrame,
    text: Callable[[str], str],
    number: Callable[[float | None], str],
) -> Iterator[list[str]]:
    for row in table.iter_rows():
        yield [
            number(value)
            if value is None or (isinstance(value, int | float) and not isinstance(value, bool))
            else text(str(value))
            for value in row
        ]


def _markdown_text(text: str) -> str:
    return " ".join(text.split()).replace("\\", "\\\\").replace("|", "\\|")


def _latex_text(text: str) -> str:
    return LATEX_SPECIAL.sub(lambda found: LATEX[found[0]], " ".join(text.split()))


def _latex_number(value: float | None) -> str:
    told = plain_number(value)
    if power := POWER.fullmatch(told):
        return rf"${power[1]} \times 10^{{{int(power[2])}}}$"
    if "inf" in told:
        return told.replace("inf", r"$\infty$").replace("-$", "$-")
    return f"${told}$" if told.startswith("-") else told or "--"
