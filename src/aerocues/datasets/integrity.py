"""Finds truncated or damaged files by their structure, without decoding them.

OpenCV fills the missing part of a truncated JPEG or PNG with gray, without an error. What libjpeg
and libtiff complain of, they write to the standard error.
"""

from __future__ import annotations

import re
import zlib

_NEXT_MARKER = re.compile(rb"\xff[\x01-\xcf\xd8-\xfe]")
_END_OF_IMAGE = 0xD9
_START_OF_SCAN = 0xDA
_COMPLAINTS = re.compile(
    rb"(Corrupt JPEG data: .*|Premature end of JPEG.*|Inconsistent progression.*"
    rb"|Invalid SOS parameters.*|Unsupported marker type.*)|TIFF_Error (.*)"
)
_EXTRANEOUS = re.compile(rb"Corrupt JPEG data: (\d+) extraneous bytes before marker 0xd9")
ANY_PADDING, MOST_PADDING = 4, 64
_WITHOUT_LENGTH = frozenset({0x01, *range(0xD0, 0xD9)})


def find_damage(data: bytes, image_format: str) -> str | None:
    """A description of the damage in the structure of a file, or None.

    Parameters
    ----------
    data : bytes
        The whole file.
    image_format : str
        As in `Header.format`. JPEG is checked segment by segment up to its end marker, PNG chunk by
        chunk with checksums; for other formats the decoders are strict enough.
    """
    if image_format == "JPEG":
        return _jpeg_damage(data)
    if image_format == "PNG":
        return _png_damage(data)
    return None


def find_complaint(written: bytes, data: bytes) -> str | None:
    """What a decoder complained of, or None.

    Parameters
    ----------
    written : bytes
        What it wrote to the standard error.
    data : bytes
        The whole file. Some cameras fill up the image data with a few equal bytes, which is no
        damage.
    """
    for found in _COMPLAINTS.finditer(written):
        padded = _EXTRANEOUS.match(found[0])
        if padded is None or not _is_padding(data, int(padded[1])):
            text = (found[1] or found[2]).decode("ascii", "replace").strip()
            return f"it is damaged ({text})"
    return None


def _is_padding(data: bytes, count: int) -> bool:
    """Whether the end marker comes after a few bytes, or after some that are equal."""
    if count <= ANY_PADDING or count > MOST_PADDING:
        return count <= ANY_PADDING
    return any(bytes([value]) * count + b"\xff\xd9" in data for value in (0, 0xFF))


def _jpeg_damage(data: bytes) -> str | None:
    # Segment by segment, because thumbnails in the EXIF segment have end markers, too.
    position = 2
    while (found := _NEXT_MARKER.search(data, position)) is not None:
        marker, position = data[found.end() - 1], found.end()
        if marker == _END_OF_IMAGE:
            return None
        if marker not in _WITHOUT_LENGTH:
            position += int.from_bytes(data[position : position + 2], "big")
    return "it is truncated (no end of image)"


def _png_damage(data: bytes) -> str | None:
    position = 8
    while position + 12 <= len(data):
        length = int.from_bytes(data[position : position + 4], "big")
        kind = data[position + 4 : position + 8]
        end = position + 8 + length
        if kind == b"IEND":
            return None
        if end + 4 > len(data):
            break
        critical = kind[:1].isupper()
        checksum = int.from_bytes(data[end : end + 4], "big")
        if critical and zlib.crc32(memoryview(data)[position + 4 : end]) != checksum:
            return f"it is damaged (checksum of chunk {kind.decode('latin-1')})"
        position = end + 4
    return "it is truncated (no end of image)"


def without_text(data: bytes) -> bytes:
    """A PNG file without its chunks of compressed text."""
    kept, position = [data[:8]], 8
    while position + 12 <= len(data):
        end = position + 12 + int.from_bytes(data[position : position + 4], "big")
        if data[position + 4 : position + 8] not in (b"zTXt", b"iTXt"):
            kept.append(data[position:end])
        position = end
    return b"".join(kept)
