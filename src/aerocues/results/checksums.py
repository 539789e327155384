"""A checksum inside each table that aerocues writes, where readers of Parquet do not look.

It stands between the pages and the footer: readers find pages by the footer, so that the file is
Parquet like any other, and it is one file, which is replaced and copied as a whole.
"""

from __future__ import annotations

import zlib
from io import BufferedIOBase, FileIO

MARK = b"aerocues-crc32:"
DIGITS = 8
END = 8
"""Bytes after the footer: its length, and the mark of Parquet."""
BLOCK = 1 << 18
RawFile = FileIO | BufferedIOBase


def with_checksum(parquet: bytes) -> bytes:
    """The content of a Parquet file with the checksum of all of it."""
    place = len(parquet) - END - int.from_bytes(parquet[-END : -END // 2], "little")
    pages, footer = memoryview(parquet)[:place], memoryview(parquet)[place:]
    checksum = zlib.crc32(footer, zlib.crc32(pages))
    return b"".join((pages, MARK, _written(checksum), footer))


def agrees_with_checksum(file: RawFile) -> bool | None:
    """Whether a file is as it was written; None where it has no checksum, like older ones."""
    place = _place(file)
    if place is None:
        return None
    # Into one block of memory: new memory would cost more than the checksum.
    buffer = memoryview(bytearray(BLOCK))
    file.seek(0)
    checksum = _of_next(file, buffer, place, 0)
    stated = file.read(len(MARK) + DIGITS)[len(MARK) :]
    return stated == _written(_of_next(file, buffer, None, checksum))


def _place(file: RawFile) -> int | None:
    """Where the mark is; in a file with a damaged end it is looked for."""
    size = file.seek(0, 2)
    file.seek(max(size - END, 0))
    place = size - END - int.from_bytes(file.read(END // 2), "little") - len(MARK) - DIGITS
    if place > 0:
        file.seek(place)
        if file.read(len(MARK)) == MARK:
            return place
    file.seek(0)
    place = file.read().rfind(MARK)
    return place if place >= 0 else None


def _of_next(file: RawFile, buffer: memoryview, length: int | None, checksum: int) -> int:
    """The checksum that goes on over the next bytes; all there are, without a length."""
    left = length
    while left != 0:
        size = file.readinto(buffer if left is None else buffer[:left])
        if not size:
            break
        checksum = zlib.crc32(buffer[:size], checksum)
        left = None if left is None else left - size
    return checksum


def _written(checksum: int) -> bytes:
    return f"{checksum:0{DIGITS}x}".encode()
