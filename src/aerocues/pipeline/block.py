"""A connected block of a large flight that holds every class of pairs."""

from __future__ import annotations

from aerocues.pipeline.survey import Survey

MOST_IMAGES = 30
"""A model of so many images predicts that of the whole flight and takes seconds."""


def connected_block(survey: Survey, most: int = MOST_IMAGES) -> list[str]:
    """Images of a flight that hang together, over neighbouring strips.

    It begins with the strongest turned pair, if there is one, and takes the image that is linked
    best with what it holds already, again and again.

    Parameters
    ----------
    survey : Survey
    most : int
        Images, 2 or more.

    Returns
    -------
    list of str
        Names in the order of the flight; all that are linked where there are no more.
    """
    if not survey.pairs:
        return list(survey.images[:most])
    links: dict[int, dict[int, int]] = {}
    for pair in survey.pairs:
        links.setdefault(pair.image_1, {})[pair.image_2] = pair.inliers
        links.setdefault(pair.image_2, {})[pair.image_1] = pair.inliers
    turned = [pair for pair in survey.pairs if pair.kind == "turned"]
    first = max(turned or survey.pairs, key=lambda pair: pair.inliers)
    block = {first.image_1, first.image_2}
    while len(block) < most:
        reach = {
            image: sum(count for other, count in own.items() if other in block)
            for image, own in links.items()
            if image not in block
        }
        best = max(reach, key=lambda image: (reach[image], -image), default=None)
        if best is None or not reach[best]:
            break
        block.add(best)
    return [survey.images[image] for image in sorted(block)]
