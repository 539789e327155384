"""Text that other programs wrote: in UTF-8, or in UTF-16 as spreadsheets write it."""

from __future__ import annotations

import codecs

MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
"""Marks of the byte order that a file may begin with, and the encodings that take them away."""


def decoded(content: bytes) -> str:
    """The text of a file.

    Raises
    ------
    ValueError
        If it is not text in UTF-8 or, with a mark of the byte order, UTF-16.
    """
    encoding = next((name for mark, name in MARKS if content.startswith(mark)), "utf-8")
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise ValueError(f"line {line} is not UTF-8; save it as UTF-8") from error
    if "\0" in text:
        raise ValueError("it is not text in UTF-8; save it as UTF-8")
    return text
