"""Keeps the page small enough for email, by leaving out pictures and clouds."""

from __future__ import annotations

import json
from collections.abc import Sequence
from itertools import chain, zip_longest
from typing import Any

from aerocues.report.clouds import Clouds
from aerocues.report.pictures import Pictures


def fitting(found: Sequence[Pictures], room: int) -> Pictures:
    """As many pictures as fit, the most important of each entry first.

    Parameters
    ----------
    found : sequence of Pictures
        One per entry.
    room : int
        Number of bytes.
    """
    images = {key: image for each in found for key, image in each.images.items()}
    kept = Pictures(notes=[note for each in found for note in each.notes])
    # The first of every entry comes before the second of any.
    turns = chain.from_iterable(zip_longest(*(each.pictures for each in found)))
    left_out = 0
    for picture in filter(None, turns):
        new = {key: images[key] for key in (picture["image_1"], picture["image_2"])}
        new = {key: image for key, image in new.items() if key not in kept.images}
        needed = size_of(picture) + sum(size_of(image) for image in new.values())
        if left_out or needed > room:
            left_out += 1
            continue
        room -= needed
        kept.images.update(new)
        kept.pictures.append(picture)
    if left_out:
        kept.notes.append(
            f"{left_out} of {left_out + len(kept.pictures)} pictures are left out to keep the page "
            "small"
        )
    return kept


def fitting_clouds(found: Sequence[Clouds], room: int) -> Clouds:
    """As many clouds as fit, the most important of each entry first.

    Parameters
    ----------
    found : sequence of Clouds
        One per entry.
    room : int
        Number of bytes.
    """
    kept = Clouds(notes=[note for each in found for note in each.notes])
    turns = list(filter(None, chain.from_iterable(zip_longest(*(each.clouds for each in found)))))
    for cloud in turns:
        room -= size_of(cloud)
        if room < 0:
            break
        kept.clouds.append(cloud)
    left_out = len(turns) - len(kept.clouds)
    if left_out:
        kept.notes.append(f"{left_out} of {len(turns)} clouds are left out to keep the page small")
    return kept


def size_of(facts: dict[str, Any]) -> int:
    """Number of bytes as JSON, including the key and commas."""
    return len(json.dumps(facts, separators=(",", ":"))) + 200
