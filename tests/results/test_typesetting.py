"""Tables for people."""

from __future__ import annotations

from pathlib import Path

import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aerocues.results.export import export_table
from aerocues.results.typesetting import as_latex, as_markdown, plain_number

TABLE = pl.DataFrame(
    {
        "combination": ["GFTT_H-SIFT-L2-BF", "50 % & #1 | {$x^2~\\}\nmore"],
        "score_low": [0.882149, None],
        "inliers": [123456, -7],
        "seconds": [-1.5e-7, 12345.6],
    }
)


def test_markdown(tmp_path: Path) -> None:
    export_table(TABLE, tmp_path / "table.md", "markdown")
    assert (tmp_path / "table.md").read_text() == (
        "| combination | score_low | inliers | seconds |\n"
        "| --- | ---: | ---: | ---: |\n"
        "| GFTT_H-SIFT-L2-BF | 0.8821 | 123456 | -1.500e-07 |\n"
        "| 50 % & #1 \\| {$x^2~\\\\} more |  | -7 | 12346 |\n"
    )


def test_latex(tmp_path: Path) -> None:
    export_table(TABLE, tmp_path / "table.tex", "latex")
    assert (tmp_path / "table.tex").read_text().splitlines() == [
        r"% needs \usepackage{booktabs}",
        r"\begin{tabular}{lrrr}",
        r"\toprule",
        r"combination & score\_low & inliers & seconds \\",
        r"\midrule",
        r"GFTT\_H-SIFT-L2-BF & 0.8821 & 123456 & $-1.500 \times 10^{-7}$ \\",
        r"50 \% \& \#1 \textbar{} \{\$x\textasciicircum{}2\textasciitilde{}\textbackslash{}\} more"
        r" & -- & $-7$ & 12346 \\",
        r"\bottomrule",
        r"\end{tabular}",
    ]


@pytest.mark.parametrize(
    ("value", "told"),
    [
        (0.0, "0"),
        (-0.0, "0"),
        (1.0, "1.000"),
        (0.88, "0.8800"),
        (99.999, "100.0"),
        (999.96, "1000"),
        (123456.7, "123457"),
        (2**60, str(2**60)),
        (float("nan"), ""),
        (None, ""),
    ],
)
def test_numbers_have_four_digits(value: float | None, told: str) -> None:
    assert plain_number(value) == told


@given(st.floats(allow_nan=False, allow_infinity=False, width=32))
def test_rounding_is_small(value: float) -> None:
    assert float(plain_number(value)) == pytest.approx(value, rel=6e-4, abs=0)


def test_what_is_no_number_is_written_too() -> None:
    table = pl.DataFrame(
        {"yes": [True], "many": [[1, 2]], "far": [float("inf")], "near": [float("-inf")]}
    )
    assert as_markdown(table).splitlines()[-1] == "| True | [1, 2] | inf | -inf |"
    assert as_latex(table).splitlines()[-3] == r"True & [1, 2] & $\infty$ & $-\infty$ \\"


def test_a_table_without_rows_has_its_head() -> None:
    assert as_markdown(TABLE.clear()).count("\n") == 2
    assert as_latex(TABLE.clear()).count("\\\\") == 1
