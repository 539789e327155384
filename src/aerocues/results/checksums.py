"""A checksum inside each table that aerocues writes, where readers of Parquet do not look.

It stands between the pages and the footer: readers find pages by the footer, so that the file is
Parquet like any other, and it is one file, which is replaced and copied as a whole.
"""

from __future__ import annotations

import zlib

MARK = b"aerocues-crc32:"
DIGITS = 8
END = 8
"""Bytes after the footer: its length, and the mark of Parquet."""


def with_checksum(parquet: bytes) -> bytes:
    """The content of a Parquet file with the checksum of all of it."""
    place = len(parquet) - END - int.from_bytes(parquet[-END : -END // 2], "little")
    pages, footer = memoryview(parquet)[:place], memoryview(parquet)[place:]
    return b"".join((pages, MARK, _checksum(pages, footer), footer))


def agrees_with_checksum(content: bytes) -> bool | None:
    """Whether a file is as it was written; None where it has no checksum, like older ones."""
    place = content.rfind(MARK)
    if place < 0:
        return None
    behind = place + len(MARK) + DIGITS
    checksum = _checksum(memoryview(content)[:place], memoryview(content)[behind:])
    return content[place + len(MARK) : behind] == checksum


def _checksum(pages: memoryview, footer: memoryview) -> bytes:
    return f"{zlib.crc32(footer, zlib.crc32(pages)):0{DIGITS}x}".encode()
