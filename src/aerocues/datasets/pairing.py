"""Strategies that choose image pairs, and their text form."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Image
from aerocues.datasets.overlap import Overlapping
from aerocues.datasets.usable_gps import UsableGps
from aerocues.errors import DatasetError

Names = tuple[str, str]
GPS_NEIGHBOURS = 8
FORMS = (
    "consecutive, consecutive:K, exhaustive, gps, gps:K, gps:50m, overlap:0.3-0.9 (where depth is "
    "known) or a file of pairs"
)


class PairStrategy(Protocol):
    """Chooses pairs among ordered images."""

    def pairs(self, images: Sequence[Image]) -> list[Names]:
        """Names of the images to match, in order, without duplicates.

        Raises
        ------
        DatasetError
            If the images do not have what the strategy needs.
        """


@dataclass(frozen=True)
class Consecutive:
    """Each image with the next `neighbours` images."""

    neighbours: int = 1

    def pairs(self, images: Sequence[Image]) -> list[Names]:
        return [
            (first.name, second.name)
            for position, first in enumerate(images)
            for second in images[position + 1 : position + 1 + self.neighbours]
        ]


@dataclass(frozen=True)
class Exhaustive:
    """All pairs of images."""

    def pairs(self, images: Sequence[Image]) -> list[Names]:
        return list(combinations([image.name for image in images], 2))


@dataclass(frozen=True)
class GpsNeighbours:
    """Images taken close to each other: horizontal distance by GPS.

    Parameters
    ----------
    nearest : int
        Each image with its nearest neighbours; used if `radius` is None.
    radius : float or None
        All pairs of images within this distance in metres.

    Notes
    -----
    An image whose position is missing or cannot be right is placed between its neighbours in the
    order, if at least half of the positions can be used.
    """

    nearest: int = GPS_NEIGHBOURS
    radius: float | None = None

    def pairs(self, images: Sequence[Image]) -> list[Names]:
        from scipy.spatial import cKDTree

        positions = _horizontal_positions(images)
        tree = cKDTree(positions)
        if self.radius is not None:
            found = {(int(i), int(j)) for i, j in tree.query_pairs(self.radius)}
        else:
            count = min(self.nearest + 1, len(images))
            _, indices = tree.query(positions, k=count)
            found = {
                (min(i, int(j)), max(i, int(j)))
                for i, row in enumerate(indices.reshape(len(images), count))
                for j in [other for other in row if other != i][: self.nearest]
            }
        if not found:
            raise DatasetError(f"no two images are within {self.radius} m; give a larger radius")
        return [(images[i].name, images[j].name) for i, j in sorted(found)]


def _horizontal_positions(images: Sequence[Image]) -> NDArray[np.float64]:
    usable = UsableGps.of([image.gps for image in images])
    located = usable.horizontal()
    if located is None:
        faults = zip(images, usable.in_plan, strict=True)
        missing = [image.name for image, fault in faults if fault is not None]
        raise DatasetError(
            f"{len(missing)} of {len(images)} images have no usable GPS position "
            f'({_listed(missing)}); use `pairs="consecutive"` or `pairs="exhaustive"`'
        )
    return located


@dataclass(frozen=True)
class PairsFile:
    """Pairs listed in a text file: two names per line, separated by blanks or a tab.

    Names with blanks need double quotes (or a tab in the line). ``#`` begins a comment at the start
    of a line or after a blank. A repeated pair counts once.
    """

    path: Path

    def pairs(self, images: Sequence[Image]) -> list[Names]:
        try:
            text = self.path.read_text(encoding="utf-8-sig")
        except OSError as error:
            raise DatasetError(
                f"cannot read the pairs file {self.path}: {error.strerror}; check its path"
            ) from error
        except UnicodeDecodeError as error:
            raise DatasetError(
                f"the pairs file {self.path} is not UTF-8 text; save it as UTF-8"
            ) from error
        return parse_pairs_file(text, [image.name for image in images], str(self.path))


def parse_pairs_file(text: str, names: Sequence[str], where: str = "pairs file") -> list[Names]:
    """The pairs in the text of a pairs file.

    Raises
    ------
    DatasetError
        If a line does not have two different names of `names`; the message lists the first five
        such lines with their numbers.
    """
    known = set(names)
    pairs: dict[Names, None] = {}
    faults: list[str] = []
    for number, line in enumerate(text.splitlines(), start=1):
        fields = _fields(line)
        if not fields:
            continue
        fault = _fault(fields, known)
        if fault is None:
            pairs[(fields[0], fields[1])] = None
        else:
            faults.append(f"line {number}: {fault}")
    if faults:
        rest = f"; and {len(faults) - 5} more" if len(faults) > 5 else ""
        raise DatasetError(
            f"{where} has {len(faults)} bad line{'s' * (len(faults) > 1)}: "
            f"{'; '.join(faults[:5])}{rest}; write two image names per line"
        )
    if not pairs:
        raise DatasetError(f"{where} lists no pairs; write two image names per line")
    return list(pairs)


def _fields(line: str) -> list[str]:
    content = re.sub(r"(^|\s)#.*$", "", line).strip()
    if "\t" in content:
        return [field.strip().strip('"') for field in content.split("\t") if field.strip()]
    return [quoted or plain for quoted, plain in re.findall(r'"([^"]+)"|(\S+)', content)]


def _fault(fields: Sequence[str], known: set[str]) -> str | None:
    from difflib import get_close_matches

    if len(fields) != 2:
        return f"{len(fields)} name{'s' * (len(fields) != 1)} instead of 2"
    for name in fields:
        if name not in known:
            close = get_close_matches(name, known, n=1)
            return f"no image '{name}'" + (f" (did you mean '{close[0]}'?)" if close else "")
    return "an image with itself" if fields[0] == fields[1] else None


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:3]) + (", ..." if len(names) > 3 else "")


def _overlapping(limits: str) -> PairStrategy:
    least, _, most = limits.partition("-")
    low, high = float(least), float(most or 1.0)
    if not 0.0 < low <= high <= 1.0:
        raise DatasetError(f'`pairs="overlap:{limits}"`: give shares of an image such as 0.3-0.9')
    return Overlapping(low, high)


_PATTERNS: tuple[tuple[str, Callable[[str], PairStrategy]], ...] = (
    (r"consecutive", lambda _: Consecutive()),
    (r"consecutive:([1-9]\d*)", lambda count: Consecutive(int(count))),
    (r"exhaustive", lambda _: Exhaustive()),
    (r"gps", lambda _: GpsNeighbours()),
    (r"gps:([1-9]\d*)", lambda count: GpsNeighbours(int(count))),
    (r"gps:(\d+(?:\.\d+)?)\s*m", lambda metres: GpsNeighbours(radius=float(metres))),
    (r"overlap:((?:\d*\.)?\d+(?:-(?:\d*\.)?\d+)?)", _overlapping),
)


def parse_pairs(text: str) -> PairStrategy:
    """The strategy of a text form, such as ``consecutive:3``, ``gps:50m`` or a path.

    Raises
    ------
    DatasetError
        If it is neither a known form nor an existing file.
    """
    for pattern, strategy in _PATTERNS:
        if match := re.fullmatch(pattern, text.strip(), flags=re.IGNORECASE):
            return strategy(match[match.lastindex or 0])
    path = Path(text).expanduser()
    if path.is_file():
        return PairsFile(path.absolute())
    raise DatasetError(f'`pairs="{text}"` is neither a way to pair nor a file; use {FORMS}')
