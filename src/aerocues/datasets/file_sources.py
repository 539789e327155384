"""The files of a scene as sources of images, all read alike: one band, one range of values."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from aerocues.datasets.bands import files_of_band
from aerocues.datasets.decoding import FileSource
from aerocues.datasets.header import Header
from aerocues.datasets.levels import Levels, common_levels, sampled, spread_over
from aerocues.datasets.options import Options
from aerocues.datasets.stored_values import UndecodableError, check_band
from aerocues.errors import DatasetError, ImageError

ALWAYS_8_BITS = frozenset({".jpg", ".jpeg", ".webp", ".bmp"})


def file_sources(paths: Sequence[Path], options: Options, folder: Path) -> list[FileSource]:
    """Sources of the files of a scene, in their order; fewer where bands are files of their own.

    Raises
    ------
    DatasetError
        If a band must be chosen, or the chosen one is not there.
    """
    kept = files_of_band(paths, options.band, folder)
    inside = options.band if len(kept) == len(paths) else None
    settings = (options.max_width, options.equalize)
    sources = [FileSource(path.absolute(), *settings, band=inside) for path in kept]
    headers = [_header(source) for source in sources]
    _check_bands(headers, inside, folder)
    return _with_levels(sources, headers)


def sources_alike(paths: Sequence[Path]) -> list[FileSource]:
    """Sources of some files at their full size, with one range of values."""
    sources = [FileSource(path) for path in paths]
    return _with_levels(sources, [_header(source) for source in sources])


def _with_levels(
    sources: Sequence[FileSource], headers: Sequence[Header | None]
) -> list[FileSource]:
    levels = {
        kind: found
        for kind in dict.fromkeys(header.sample_type for header in headers if header)
        if kind != "uint8" and (found := _levels(_of_type(kind, sources, headers)))
    }
    return [
        replace(source, levels=levels[header.sample_type])
        if header and header.sample_type in levels
        else source
        for source, header in zip(sources, headers, strict=True)
    ]


def told_levels(sources: Iterable[object]) -> str:
    """The ranges of values that become 0 to 255, such as ``812 to 3900``; empty for 8 bits."""
    found = [each.levels for each in sources if isinstance(each, FileSource) and each.levels]
    return ", ".join(dict.fromkeys(map(str, found)))


def _header(source: FileSource) -> Header | None:
    """The header of a file that may have more than 8 bits or several bands."""
    if source.path.suffix.lower() in ALWAYS_8_BITS and source.band is None:
        return None
    try:
        return source.header()
    except ImageError:
        return None  # an error of the pairs with this image, raised when it is read


def _check_bands(headers: Sequence[Header | None], band: int | None, folder: Path) -> None:
    """Refuse images of which most cannot be read with this choice; others are errors of pairs."""
    refused = []
    for header in headers:
        try:
            if header is not None:
                check_band(header, band)
        except UndecodableError as error:
            refused.append(str(error))
    if refused and 2 * len(refused) > len(headers):
        raise DatasetError(
            f"{len(refused)} of {len(headers)} images of {folder} cannot be read: {refused[0]}"
        )


def _of_type(
    kind: str, sources: Sequence[FileSource], headers: Sequence[Header | None]
) -> list[FileSource]:
    return [
        source
        for source, header in zip(sources, headers, strict=True)
        if header and header.sample_type == kind
    ]


def _levels(sources: Sequence[FileSource]) -> Levels | None:
    samples = []
    for source in spread_over(sources):
        try:
            samples.append(sampled(source.stored().finite))
        except ImageError:
            continue  # an error of the pairs with this image, raised when it is read
    return common_levels(samples)
