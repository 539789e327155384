"""Where the images of a flight were taken and what they show, with small pictures of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Image
from aerocues.datasets.gps import east_north_up
from aerocues.datasets.usable_gps import UsableGps
from aerocues.errors import AerocuesError, ImageError
from aerocues.report.entry import ReportEntry
from aerocues.report.footprints import footprint
from aerocues.report.reopening import context_of
from aerocues.report.thumbnails import thumbnail

WIDTH = 112
"""Of the pictures, in pixels: they only have to be told apart."""
MOST_PICTURES = 60
MOST_IMAGES = 1000
FEWEST_IMAGES = 3
Positions = NDArray[np.float64]


@dataclass(frozen=True)
class FlightMap:
    """The images of an entry on a map.

    Attributes
    ----------
    facts : dict or None
        For the payload; None where the images are no flight.
    notes : list of str
    """

    facts: dict[str, Any] | None = None
    notes: list[str] = field(default_factory=list)


def flight_map(found: ReportEntry, moved: Sequence[str] = ()) -> FlightMap:
    """The map of an entry whose images show one scene with depth.

    Parameters
    ----------
    found : ReportEntry
    moved : sequence of str
        New locations of images that have moved; see `reopening.context_of`.
    """
    pairs = found.pairs()
    names = list(dict.fromkeys(pair[key] for pair in pairs for key in ("image_1", "image_2")))
    measured = found.settings.get("dataset") or {}
    one_scene = len({pair["sequence"] for pair in pairs}) == 1
    if not one_scene or measured.get("geometry") != "epipolar" or len(names) < FEWEST_IMAGES:
        return FlightMap()
    if len(names) > MOST_IMAGES:
        return FlightMap(notes=[f"{found.name}: no map: more than {MOST_IMAGES:,} images"])
    try:
        dataset = context_of(found, moved).dataset
    except AerocuesError as error:
        return FlightMap(notes=[f"{found.name}: no map: {error}"])
    images = dataset.images
    if len(images) > MOST_IMAGES:
        own = set(names)
        images = [image for image in images if image.name in own]
    known, positions = _positions(images)
    grounds = _footprints(images, positions) if known != "order" else [None] * len(images)
    return FlightMap(
        {
            "entry": found.name,
            "known": known,
            "images": [
                {"name": image.name, "x": x, "y": y, "src": source, "ground": ground}
                for image, (x, y), source, ground in zip(
                    images, positions.tolist(), _pictures(images), grounds, strict=True
                )
            ],
        }
    )


def _positions(images: Sequence[Image]) -> tuple[str, Positions]:
    """Source and (images, 2) metres to the east and north; by order where nothing is known."""
    true = [image.truth.centre[:2] for image in images if image.truth is not None]
    if len(true) == len(images):
        return "truth", np.array(true)
    usable = UsableGps.of([image.gps for image in images])
    places = [
        position
        for position, fault in zip(usable.positions, usable.in_plan, strict=True)
        if position is not None and fault is None
    ]
    if len(places) == len(images):
        return "gps", east_north_up(places)[:, :2]
    return "order", _in_rows(len(images))


def _footprints(images: Sequence[Image], positions: Positions) -> list[list[list[float]] | None]:
    """Corners of the images on the ground, as far as they are known; see `footprints`."""
    corners = [footprint(*each) for each in zip(images, positions.tolist(), strict=True)]
    return [None if each is None else each.round(1).tolist() for each in corners]


def _in_rows(count: int) -> Positions:
    """Places in rows to and fro, as a survey is flown, for images without positions."""
    columns = int(np.ceil(np.sqrt(2 * count)))
    row, column = np.divmod(np.arange(count), columns)
    return np.stack([np.where(row % 2, columns - 1 - column, column), -row], axis=1).astype(float)


def _pictures(images: Sequence[Image]) -> list[str | None]:
    """Data URLs of the images; None for those of a large flight, and for unreadable ones."""
    found: list[str | None] = [None] * len(images)
    if len(images) > MOST_PICTURES:
        return found
    for number, image in enumerate(images):
        try:
            found[number] = thumbnail(image, WIDTH).src
        except ImageError:  # its pairs failed, too: the table says so
            continue
    return found
