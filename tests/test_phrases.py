"""Texts of others in messages and tables."""

from __future__ import annotations

import os

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aerocues.phrases import number_text, printable


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("DJI_0001.JPG", "DJI_0001.JPG"),
        ("Flüge/航拍\u3000 1.jpg", "Flüge/航拍\u3000 1.jpg"),
        (os.fsdecode(b"fl\xfcg.jpg"), r"fl\xfcg.jpg"),
        ("a\x1b[31m\n.jpg", r"a\x1b[31m\n.jpg"),
        ("gpj\u202e.exe", r"gpj\u202e.exe"),
        ("\ud800", r"\ud800"),
    ],
)
def test_only_what_cannot_be_printed_is_escaped(text: str, expected: str) -> None:
    assert printable(text) == expected


@given(st.binary(max_size=20))
def test_any_name_of_a_file_can_be_stored_and_printed(name: bytes) -> None:
    text = printable(os.fsdecode(name))
    text.encode()
    assert "\x1b" not in text
    assert printable(text) == text


def test_a_number_that_is_not_known_is_a_dash() -> None:
    assert [number_text(value, 2) for value in (0.125, -3.0, float("nan"))] == [
        "0.12",
        "-3.00",
        "-",
    ]
