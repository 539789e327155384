"""TIFF files of any kind, written by hand: what no library at hand writes."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

KINDS = {"u": 1, "i": 2, "f": 3}
ASCII, SHORT, LONG = 2, 3, 4


def tiff_bytes(
    *pages: NDArray[Any],
    photometric: int = 1,
    planar: bool = False,
    deflate: bool = False,
    predictor: int = 1,
    tile: int = 0,
    order: str = "<",
    tags: dict[int, Any] | None = None,
    kinds: tuple[int, ...] = (),
) -> bytes:
    """A file of pages, each (H, W) or (H, W, N).

    Parameters
    ----------
    pages
    photometric : int
        0: white is the least value; 1: gray or bands; 2: colours.
    planar : bool
        Bands after each other, not interleaved.
    tile : int
        Side of tiles in pixels, a multiple of 16; 0: strips of 16 rows.
    order : str
        ``<`` or ``>``.
    tags : dict
        More tags of all pages: whole numbers or texts.
    kinds : tuple of int
        NewSubfileType of the pages; 1: a thumbnail.
    """
    content = (b"II*\0" if order == "<" else b"MM\0*") + b"\0" * 4
    link = 4
    for number, page in enumerate(pages):
        values = page[..., None] if page.ndim == 2 else page
        height, width, samples = values.shape
        parts, starts = _parts(values, planar, tile, predictor, order), []
        packed = [zlib.compress(part) if deflate else part for part in parts]
        for part in packed:
            starts.append(len(content))
            content += part + b"\0" * (len(part) % 2)
        found: dict[int, Any] = {
            254: kinds[number] if kinds else 0,
            256: width,
            257: height,
            258: (8 * page.dtype.itemsize,) * samples,
            259: 8 if deflate else 1,
            262: photometric,
            277: samples,
            284: 2 if planar else 1,
            317: predictor,
            339: (KINDS[page.dtype.kind],) * samples,
            **({322: tile, 323: tile} if tile else {278: 16}),
            324 if tile else 273: tuple(starts),
            325 if tile else 279: tuple(map(len, packed)),
            **(tags or {}),
        }
        if samples > 1 and photometric != 2:
            found[338] = (0,) * (samples - 1)
        content, link = _with_directory(content, found, link, order)
    return content


def _parts(
    values: NDArray[Any], planar: bool, tile: int, predictor: int, order: str
) -> list[bytes]:
    bands = [values[..., [i]] for i in range(values.shape[2])] if planar else [values]
    parts = []
    for band in bands:
        height, width, samples = band.shape
        if tile:
            room = np.zeros(
                (-(-height // tile) * tile, -(-width // tile) * tile, samples), band.dtype
            )
            room[:height, :width] = band
            blocks = [
                room[y : y + tile, x : x + tile]
                for y in range(0, room.shape[0], tile)
                for x in range(0, room.shape[1], tile)
            ]
        else:
            blocks = [band[y : y + 16] for y in range(0, height, 16)]
        if predictor == 2:
            blocks = [np.concatenate([b[:, :1], np.diff(b, axis=1)], axis=1) for b in blocks]
        parts += [block.astype(block.dtype.newbyteorder(order)).tobytes() for block in blocks]
    return parts


def _with_directory(
    content: bytes, tags: dict[int, Any], link: int, order: str
) -> tuple[bytes, int]:
    entries = b""
    for tag in sorted(tags):
        value = tags[tag]
        if isinstance(value, str):
            kind, data, count = ASCII, value.encode() + b"\0", len(value) + 1
        else:
            numbers = value if isinstance(value, tuple) else (value,)
            kind, count = (LONG if tag in (273, 279, 324, 325) else SHORT), len(numbers)
            data = struct.pack(f"{order}{count}{'I' if kind == LONG else 'H'}", *numbers)
        if len(data) > 4:
            entries += struct.pack(f"{order}HHII", tag, kind, count, len(content))
            content += data + b"\0" * (len(data) % 2)
        else:
            entries += struct.pack(f"{order}HHI", tag, kind, count) + data.ljust(4, b"\0")
    at = len(content)
    content = content[:link] + struct.pack(f"{order}I", at) + content[link + 4 :]
    content += struct.pack(f"{order}H", len(tags)) + entries + b"\0" * 4
    return content, len(content) - 4


def write_tiff(path: Path, *pages: NDArray[Any], **options: Any) -> Path:
    """Write a file; see `tiff_bytes`."""
    path.write_bytes(tiff_bytes(*pages, **options))
    return path
