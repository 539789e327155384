"""CSV of spreadsheets and other programs: read right, or refused with the row and the cause."""

from __future__ import annotations

from pathlib import Path

import pytest

from aerocues.errors import DamageWarning, StoreError
from aerocues.results.csv_files import CsvError, read_csv
from aerocues.results.importing import import_results

HEADING = (
    "dataset,detector,descriptor,norm,matcher,pair,precision,recall,repeatability,f1_score,"
    "inliers,matches,seconds_per_1k_matches,seconds_per_1k_inliers"
)
ROWS = (
    "quarry,orb,orb,ham,bf,0,0.61,0.20,0.21,0.30,610,1000,0.08,0.13",
    "quarry,sift,sift,l2,bf,0,0.72,0.22,0.24,0.34,504,700,0.31,0.43",
    "quarry,sift,sift,l2,bf,1,,,,,,,,",
)
PLAIN = "\n".join((HEADING, *ROWS)) + "\n"
GERMAN = PLAIN.replace(",", ";").replace(".", ",")
NUMBERED = "\n".join(("," + HEADING, *(f"{n},{row}" for n, row in enumerate(ROWS)))) + "\n"
QUOTED = GERMAN.replace(";", '","').replace("\n", '"\n"')[:-1]

DIALECTS = {
    "plain": PLAIN.encode(),
    "with a mark": PLAIN.encode("utf-8-sig"),
    "utf-16": PLAIN.encode("utf-16"),
    "utf-16 big end first": b"\xfe\xff" + PLAIN.encode("utf-16-be"),
    "carriage returns": PLAIN.replace("\n", "\r").encode(),
    "both": PLAIN.replace("\n", "\r\n").encode(),
    "semicolons": PLAIN.replace(",", ";").encode(),
    "semicolons and decimal commas": GERMAN.encode(),
    "quoted decimal commas": ('"' + QUOTED).encode(),
    "tabs": PLAIN.replace(",", "\t").encode(),
    "sep": b"sep=,\r\n" + PLAIN.encode(),
    "sep of its own": b"sep=^\n" + PLAIN.replace(",", "^").encode(),
    "comments": b"# measured on board\n\n# twice\n" + PLAIN.encode(),
    "blank lines": PLAIN.replace("\n", "\n\n").encode() + b",,,,,,,,,,,,,\n",
    "separators at the ends": PLAIN.replace("\n", ",\n").encode(),
    "separators at the ends of rows": (PLAIN.replace("\n", ",\n").replace(",\n", "\n", 1)).encode(),
    "numbered rows": NUMBERED.encode(),
    "capitals": (HEADING.title() + PLAIN[len(HEADING) :]).encode(),
    "blanks": PLAIN.replace(",", " , ").encode(),
}


@pytest.mark.parametrize("dialect", DIALECTS)
def test_dialects_give_the_same_table(tmp_path: Path, dialect: str) -> None:
    (tmp_path / "t.csv").write_bytes(DIALECTS[dialect])
    [results] = import_results(tmp_path / "t.csv", tmp_path / "results")
    got = results.table().select("pair", "detector", "precision", "inliers", "status").rows()
    assert got == [
        (0, "ORB", 0.61, 610, "ok"),
        (0, "SIFT", 0.72, 504, "ok"),
        (1, "SIFT", None, None, "error"),
    ]


@pytest.mark.parametrize("cut", range(-22, -9))
def test_a_row_that_was_cut_off_is_refused(tmp_path: Path, cut: int) -> None:
    text = "\n".join((HEADING, *ROWS[:2]))[:cut]
    (tmp_path / "t.csv").write_text(text)
    with pytest.raises(StoreError, match=r"row 2 \(line 3\) has 1[0-3] fields in place of 14"):
        import_results(tmp_path / "t.csv", tmp_path / "results")


def test_a_last_line_without_an_end_is_told(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("\n".join((HEADING, *ROWS[:2]))[:-1])
    with pytest.warns(DamageWarning, match=r"t\.csv has no end; check that row 2 is whole"):
        import_results(tmp_path / "t.csv", tmp_path / "results")


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"", "no heading"),
        (b"a,b\n1,2,3\n", r"row 1 \(line 2\) has 3 fields in place of 2"),
        (b"# c\na,b\n1,2\n\n1\n", r"row 2 \(line 5\) has 1 fields"),
        (b"a,b\n\xff,1\n", "line 2 is not UTF-8"),
        (b"a\0,b\n", "not text"),
        (b"PK\x03\x04" + bytes(100), "spreadsheet"),
        (b"\xd0\xcf\x11\xe0" + bytes(100), "spreadsheet"),
        (b"a,,c\n1,2,3\n", "column 2 has no name"),
        (b",a\n5,3\n", "column 1 has no name"),
        (b"a,b,a\n1,2,3\n", "column a twice"),
        (b'a,b\n1,"2\n', "line 2: unexpected end"),
        (b'a,b\n1,"2"3\n', "line 2"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(content: bytes, told: str) -> None:
    with pytest.raises(CsvError, match=told):
        read_csv(content, "t.csv")


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("0,61", "0.61", r"has '0,72' as precision in row 2, and numbers with points"),
        (";610;", ";1.610;", r"has '0,61' as precision in row 1, and numbers with points"),
    ],
)
def test_two_decimal_marks_are_refused(tmp_path: Path, old: str, new: str, told: str) -> None:
    (tmp_path / "t.csv").write_text(GERMAN.replace(old, new))
    with pytest.raises(StoreError, match=told):
        import_results(tmp_path / "t.csv", tmp_path / "results")


def test_a_comma_between_thousands_is_not_taken_for_a_decimal_comma(tmp_path: Path) -> None:
    table = PLAIN.replace(",1000,", ',"1,000",')
    (tmp_path / "t.csv").write_text(table)
    with pytest.raises(StoreError, match=r"has '1,000' as matches in row 1, and numbers"):
        import_results(tmp_path / "t.csv", tmp_path / "results")
    whole = "\n".join((HEADING, 'a,orb,orb,ham,bf,0,1,1,1,1,"1,000","1,000",1,1')) + "\n"
    (tmp_path / "t.csv").write_text(whole)
    with pytest.raises(StoreError, match=r"has '1,000' as matches in row 1, which may stand"):
        import_results(tmp_path / "t.csv", tmp_path / "results")
