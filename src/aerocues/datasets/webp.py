"""The chunks of WebP files. Pillow's reader makes room for all pixels to read a header."""

from __future__ import annotations

from typing import IO, Any


def read_webp(stream: IO[bytes]) -> tuple[str, tuple[int, int], dict[str, Any]]:
    """Pillow's name of the pixel format, width and height, and the metadata by Pillow's names.

    Raises
    ------
    ValueError, IndexError
        If there is no image in the file.
    """
    data = stream.read()
    found: dict[bytes, bytes] = {}
    position = 12
    while position + 8 <= len(data):
        size = int.from_bytes(data[position + 4 : position + 8], "little")
        found.setdefault(data[position : position + 4], data[position + 8 : position + 8 + size])
        position += 8 + size + size % 2
    names = {"exif": b"EXIF", "xmp": b"XMP "}
    return *_format(found), {name: found[kind] for name, kind in names.items() if kind in found}


def _format(chunks: dict[bytes, bytes]) -> tuple[str, tuple[int, int]]:
    if (extended := chunks.get(b"VP8X")) is not None:
        width, height = (_number(extended, at, 3) + 1 for at in (4, 7))
        return "RGBA" if extended[0] & 0x10 else "RGB", (width, height)
    if (lossless := chunks.get(b"VP8L")) is not None:
        bits = _number(lossless, 1, 4)
        size = (bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1
        return "RGBA" if bits >> 28 & 1 else "RGB", size
    lossy = chunks.get(b"VP8 ", b"")
    return "RGB", (_number(lossy, 6, 2) & 0x3FFF, _number(lossy, 8, 2) & 0x3FFF)


def _number(data: bytes, at: int, length: int) -> int:
    if len(data) < at + length:
        raise ValueError("the header is cut off")
    return int.from_bytes(data[at : at + length], "little")
