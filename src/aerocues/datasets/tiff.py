"""The directories of TIFF files: which page is the image, and how its samples are stored."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import IO, Any, Literal

import numpy as np
from numpy.typing import NDArray

SUBFILE, WIDTH, HEIGHT, BITS, COMPRESSION, PHOTOMETRIC = 254, 256, 257, 258, 259, 262
STRIPS, ORIENTATION, SAMPLES, STRIP_SIZES, PLANAR = 273, 274, 277, 279, 284
FILL_ORDER, ROWS_PER_STRIP, TILE_HEIGHT = 266, 278, 323
PREDICTOR, TILE_WIDTH, TILES, TILE_SIZES, INSIDE, EXTRA, FORMAT = 317, 322, 324, 325, 330, 338, 339
NODATA = 42113
"""GDAL's tag for the value of pixels without content."""
MIN_IS_WHITE, RGB, PALETTE, CMYK = 0, 2, 3, 5
REDUCED, MASK = 1, 4
DEFLATE = (8, 32946)
UNPACKED_AT_ONCE = 1 << 22
MOST_PAGES = 1000
DECODABLE_SAMPLES = 4
_LONG = 4
_KINDS = {1: "uint", 2: "int", 3: "float"}


@dataclass(frozen=True, eq=False)
class Page:
    """One image of a TIFF file.

    Parameters
    ----------
    offset : int
        Of its directory in the file.
    tags : mapping of int
        By number, as Pillow reads them.
    inside : bool
        Whether another page refers to it, rather than the file.
    """

    offset: int
    tags: Any
    inside: bool = False

    def number(self, tag: int, default: int = 0) -> int:
        """The first value of a tag."""
        value = self.tags.get(tag, default)
        return int(value[0] if isinstance(value, tuple) else value)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height as stored."""
        return int(self.tags[WIDTH]), int(self.tags[HEIGHT])

    @property
    def samples(self) -> int:
        """Values of a pixel."""
        return self.number(SAMPLES, 1)

    @property
    def sample_type(self) -> str:
        """Such as ``uint8`` or ``float32``."""
        return f"{_KINDS.get(self.number(FORMAT, 1), 'other')}{self.number(BITS, 1)}"

    @property
    def bands(self) -> int:
        """Measured bands that are no colours; 1 for gray and colour images."""
        coloured = self.number(PHOTOMETRIC) not in (MIN_IS_WHITE, 1)
        known = coloured or self.has_alpha
        return 1 if known and self.samples <= DECODABLE_SAMPLES else self.samples

    @property
    def has_alpha(self) -> bool:
        """Whether a sample tells how opaque a pixel is."""
        return any(value in (1, 2) for value in self.tags.get(EXTRA, ()))

    @property
    def colours_by_band(self) -> bool:
        """Whether OpenCV would take another band for alpha, or not find all of the colours."""
        if self.number(PHOTOMETRIC) != RGB or not 3 <= self.samples <= DECODABLE_SAMPLES:
            return False
        infrared = self.samples == 4 and EXTRA in self.tags and not self.has_alpha
        return infrared or (self.number(PLANAR, 1) == 2 and self.sample_type != "uint8")

    @property
    def nodata(self) -> float | None:
        """The value of pixels without content."""
        try:
            return float(str(self.tags[NODATA]).strip("\x00 "))
        except (KeyError, ValueError):
            return None

    def spans(self) -> list[tuple[int, int]]:
        """Where each of its strips or tiles begins and ends in the file."""
        starts, sizes = (self.tags.get(tag, ()) for tag in self.parts)
        return [(int(a), int(a) + int(b)) for a, b in zip(starts, sizes, strict=False)]

    def damage(self, data: bytes) -> str | None:
        """What is wrong with its strips or tiles without decoding them, or None."""
        spans = self.spans()
        if max((end for _, end in spans), default=0) > len(data):
            return "it is truncated (its last rows are missing)"
        # libtiff ignores the checksum at the end of what zlib packed.
        packed = self.number(COMPRESSION) in DEFLATE
        if packed and not all(_is_whole(data[start:end]) for start, end in spans if start < end):
            return "it is damaged (checksum of a strip)"
        return None

    @property
    def parts(self) -> tuple[int, int]:
        """The tags of where its strips or tiles begin, and of their sizes."""
        return (TILES, TILE_SIZES) if TILES in self.tags else (STRIPS, STRIP_SIZES)


def _is_whole(packed: bytes) -> bool:
    """Whether zlib unpacks bytes to their end."""
    unpacking = zlib.decompressobj()
    try:
        while packed and not unpacking.eof:
            unpacking.decompress(packed, UNPACKED_AT_ONCE)
            packed = unpacking.unconsumed_tail
    except zlib.error:
        return False
    return unpacking.eof


def all_pages(stream: IO[bytes]) -> list[Page]:
    """All pages of a file, those inside others, too; the errors are those of Pillow."""
    from PIL.TiffImagePlugin import ImageFileDirectory_v2

    start = stream.read(8)
    start += stream.read(8) if start[2:4] in (b"+\x00", b"\x00+") else b""
    found: list[Page] = []
    waiting = [(int(ImageFileDirectory_v2(start).next), False)]
    seen = {0}
    while waiting and len(found) < MOST_PAGES:
        offset, inside = waiting.pop(0)
        if offset in seen:
            continue
        seen.add(offset)
        directory = ImageFileDirectory_v2(start)
        stream.seek(offset)
        directory.load(stream)
        tags = dict(directory)
        if WIDTH in tags and HEIGHT in tags:
            found.append(Page(offset, tags, inside))
        within = tags.get(INSIDE, ())
        waiting += [(int(each), True) for each in (within if isinstance(within, tuple) else ())]
        if not inside:
            waiting.append((int(directory.next), False))
    return found


def main_pages(found: list[Page]) -> list[Page]:
    """The pages of full size: one, or as many as the file has bands or images.

    Thumbnails and masks are left out.
    """
    full = [page for page in found if not page.number(SUBFILE) & (REDUCED | MASK)] or found
    largest = max(page.size[0] * page.size[1] for page in full)
    same = [page for page in full if page.size[0] * page.size[1] == largest]
    return [page for page in same if not page.inside] or same[:1]


def is_first(data: bytes, page: Page) -> bool:
    """Whether a page is the one that decoders take."""
    order: Literal["little", "big"] = "little" if data[:2] == b"II" else "big"
    at, size = (8, 8) if b"+" in data[:4] else (4, 4)
    return int.from_bytes(data[at : at + size], order) == page.offset


def alone(data: bytes, page: Page) -> bytes:
    """The file with a page as the first one."""
    order: Literal["little", "big"] = "little" if data[:2] == b"II" else "big"
    at, size = (8, 8) if b"+" in data[:4] else (4, 4)
    return data[:at] + page.offset.to_bytes(size, order) + data[at + size :]


def one_band(data: bytes, page: Page, band: int) -> tuple[bytes, int] | None:
    """A gray file with the values of a band, which OpenCV can decode, and their stride.

    Interleaved bands are a gray image that is as many times as wide: the band is then every
    `stride`-th value, from the number of the band on.

    Returns
    -------
    bytes, int
        None if the values are stored in another way.
    """
    predictor = page.number(PREDICTOR, 1)
    planes = page.number(PLANAR, 1) == 2
    if not planes and predictor not in (1, 2):
        return None
    stride = 1 if planes else page.samples
    kept = (HEIGHT, COMPRESSION, FILL_ORDER, ROWS_PER_STRIP, TILE_HEIGHT)
    tags = {tag: page.tags[tag] for tag in kept if tag in page.tags}
    starts, sizes = (tuple(page.tags[tag]) for tag in page.parts)
    if planes:
        own = slice(band * len(starts) // page.samples, (band + 1) * len(starts) // page.samples)
        starts, sizes = starts[own], sizes[own]
    tags |= dict(zip(page.parts, (starts, sizes), strict=True))
    tags[WIDTH] = page.size[0] * stride
    if TILE_WIDTH in page.tags:
        tags[TILE_WIDTH] = page.tags[TILE_WIDTH] * stride
    values = {BITS: page.number(BITS), FORMAT: page.number(FORMAT, 1), SAMPLES: 1, PHOTOMETRIC: 1}
    tags |= {**values, PLANAR: 1, PREDICTOR: predictor if planes else 1}
    return _with_directory(data, tags), stride


def _with_directory(data: bytes, tags: Mapping[int, Any]) -> bytes:
    """The file with a directory of whole numbers at its end, which comes first."""
    order: Literal["little", "big"] = "little" if data[:2] == b"II" else "big"
    after = data[8:] + b"\0" * (len(data) % 2)
    entries = b""
    for tag in sorted(tags):
        value = tags[tag]
        numbers = value if isinstance(value, tuple) else (value,)
        content = b"".join(int(number).to_bytes(4, order) for number in numbers)
        if len(numbers) > 1:
            content, place = (8 + len(after)).to_bytes(4, order), content
            after += place
        head = tag.to_bytes(2, order) + _LONG.to_bytes(2, order)
        entries += head + len(numbers).to_bytes(4, order) + content
    start = (8 + len(after)).to_bytes(4, order)
    directory = len(tags).to_bytes(2, order) + entries + b"\0" * 4
    return data[:2] + (42).to_bytes(2, order) + start + after + directory


def summed(values: NDArray[Any], page: Page) -> NDArray[Any]:
    """Undo the differences between neighbours that interleaved bands are stored as.

    Parameters
    ----------
    values : (H, W, N)
        Of all bands.
    page : Page
    """
    if page.number(PREDICTOR, 1) != 2:
        return values
    width = page.number(TILE_WIDTH, values.shape[1])
    pieces = [
        np.cumsum(values[:, start : start + width], axis=1, dtype=values.dtype)
        for start in range(0, values.shape[1], width)
    ]
    return np.concatenate(pieces, axis=1)
