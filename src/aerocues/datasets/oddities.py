"""What looks odd among the images of a scene: copies, sizes, cameras, gaps in time."""

from __future__ import annotations

import hashlib
from collections.abc import Hashable, Mapping
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import TypeVar

from aerocues.datasets.metadata import Metadata
from aerocues.phrases import count, spoken_seconds

COMPARED = 65_536
"""Bytes at the beginning and at the end by which files of one size are told to be copies."""
LONG_GAP = 600.0
LONG_GAP_RATIO = 20.0
MOST_NAMED = 3
_Key = TypeVar("_Key", bound=Hashable)


def oddities(paths: Mapping[str, Path], metadata: Mapping[str, Metadata]) -> list[str]:
    """What looks odd, each in a few words.

    Parameters
    ----------
    paths : mapping of str to Path
        Files by the name of the image.
    metadata : mapping of str to Metadata
    """
    sizes = {name: each.size and _upright(each.size) for name, each in metadata.items()}
    cameras = {name: each.camera or None for name, each in metadata.items()}
    return [
        *_copies(paths),
        *_several("sizes", _groups(sizes)),
        *_several("cameras", _groups(cameras)),
        *_gap(metadata),
    ]


def _upright(size: tuple[int, int]) -> str:
    """The same for both ways to hold a camera."""
    return f"{max(size)} x {min(size)}"


def _groups(keys: Mapping[str, _Key | None]) -> dict[_Key, list[str]]:
    """Names by their key, the largest group first."""
    groups: dict[_Key, list[str]] = {}
    for name, key in keys.items():
        if key is not None:
            groups.setdefault(key, []).append(name)
    return dict(sorted(groups.items(), key=lambda item: -len(item[1])))


def _several(what: str, groups: Mapping[str, list[str]]) -> list[str]:
    if len(groups) < 2:
        return []
    told = [f"{len(names)} of {key}" for key, names in groups.items()]
    rarest = list(groups.values())[-1]
    more = ", ..." if len(told) > MOST_NAMED else ""
    return [f"{len(told)} {what} ({', '.join(told[:MOST_NAMED])}{more}, such as {rarest[0]})"]


def _copies(paths: Mapping[str, Path]) -> list[str]:
    same_length = _groups({name: _length(path) for name, path in paths.items()})
    groups: list[list[str]] = []
    for names in same_length.values():
        if len(names) > 1:
            digests = {name: _digest(paths[name]) for name in names}
            groups += [group for group in _groups(digests).values() if len(group) > 1]
    if not groups:
        return []
    shown = [f"{group[1]} is {group[0]}" for group in groups[:MOST_NAMED]]
    copies = sum(len(group) - 1 for group in groups)
    more = ", ..." if copies > len(shown) else ""
    return [f"{count(copies, 'identical copy', 'identical copies')} ({', '.join(shown)}{more})"]


def _length(path: Path) -> int | None:
    try:
        return path.stat().st_size or None
    except OSError:
        return None  # an error of the pairs with this image, raised when it is read


def _digest(path: Path) -> bytes | None:
    try:
        with path.open("rb") as file:
            content = file.read(COMPARED)
            file.seek(max(file.seek(0, 2) - COMPARED, 0))
            return hashlib.sha256(content + file.read()).digest()
    except OSError:
        return None


def _gap(metadata: Mapping[str, Metadata]) -> list[str]:
    """The longest gap in time, if it is much longer than the others."""
    taken = sorted((each.taken, name) for name, each in metadata.items() if each.taken)
    gaps = [((late - early).total_seconds(), name) for (early, _), (late, name) in pairwise(taken)]
    if len(gaps) < 3:
        return []
    usual = median(seconds for seconds, _ in gaps)
    longest, name = max(gaps)
    if longest < max(LONG_GAP, LONG_GAP_RATIO * usual):
        return []
    return [f"a gap in time of {spoken_seconds(longest)} before {name}"]
