"""Builds the models of a race's leaders, and COLMAP's default beside them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from aerocues.datasets.dataset import Dataset, Pair
from aerocues.errors import FocalLengthError
from aerocues.methods.combination import Combination
from aerocues.methods.exact.availability import why_not_exact
from aerocues.methods.matchers import EXACT, MATCHERS
from aerocues.modelling.affordable import affordable_images, slowness_of
from aerocues.phrases import likelihood
from aerocues.pipeline.block import MOST_IMAGES, connected_block
from aerocues.pipeline.equal_footing import survey_image
from aerocues.pipeline.survey import Survey
from aerocues.progress import Event, Progress
from aerocues.reconstruction.options import ReconstructionOptions
from aerocues.reconstruction.protocol import ReconstructionProtocol
from aerocues.reconstruction.reconstruct import open_results, reconstruct_scene
from aerocues.results.measured_results import Results
from aerocues.tuning.final import Final
from aerocues.tuning.finalists import finalists
from aerocues.tuning.recommendation import Recommendation

MODELS = "models"
SHARE = 1 / 3
"""Of the budget, kept for the final."""
LEAST_SECONDS = 20.0
"""Less does not build a model of a few images with a few combinations."""
FEWEST_IMAGES = 3
NEAREST = frozenset(row.name for row in MATCHERS)
"""Matchers of nearest neighbours."""


def has_final(dataset: Dataset, budget: float) -> bool:
    """Whether models of the leaders can be built: one scene with depth, and enough time."""
    return (
        dataset.geometry == "epipolar"
        and len(dataset.images) >= FEWEST_IMAGES
        and len({pair.sequence for pair in dataset.pairs}) == 1
        and budget * SHARE >= LEAST_SECONDS
    )


def build_final(
    found: Recommendation,
    dataset: Dataset,
    *,
    seconds: float,
    deadline: float,
    max_keypoints: int,
    seed: int,
    workers: int | None,
    progress: Progress | None,
) -> Final:
    """Build models of the leaders with the exact matcher, and of COLMAP's default.

    Parameters
    ----------
    found : Recommendation
        What the race found.
    dataset : Dataset
        All images. Of a large flight, and on a slow machine, models are built of a connected block
        that holds all classes of pairs.
    seconds : float
        Wall time that the race left; it decides how many images are built.
    deadline : float
        Time of `time.monotonic`; what is not finished by then is left out. It is earlier than
        `seconds` from now where the race ended late.
    max_keypoints : int
        Of an image, for COLMAP's default, too; 0: all.
    seed : int
    workers : int, optional
    progress : callable, optional

    Returns
    -------
    Final
        Without rows where no model was finished.
    """
    rows = Results(found.folder).table()
    leaders = finalists(found.ranked["combination"].to_list(), rows)
    asked = tuple(dict.fromkeys(exactly_matched(each) for each in leaders))
    pixels = survey_image(dataset.images).read().bgr
    most = affordable_images(
        len(dataset.images),
        seconds,
        slowness_of(rows),
        megapixels=pixels.shape[0] * pixels.shape[1] / 1e6,
        max_keypoints=max_keypoints,
    )
    scene = scene_of_final(dataset, found.flight.survey if found.flight else None, most)
    options = ReconstructionOptions(
        preset=found.preset,
        protocol=ReconstructionProtocol(seed, max_keypoints),
        workers=workers,
        deadline=deadline,
    )
    progress = _with_leader(progress, found, deadline)
    folder, names = found.folder / MODELS, [str(each) for each in asked]
    store = open_results(found.folder, scene)
    try:
        models = reconstruct_scene(scene, names, folder, options, progress, store)
    except FocalLengthError:  # the images do not determine one either
        options = replace(options, protocol=replace(options.protocol, intrinsics="refine"))
        models = reconstruct_scene(scene, names, folder, options, progress, store)
    images = len(scene.images), len(dataset.images)
    return Final.of_models(models.table(), asked, images, folder, found.objective)


def _with_leader(
    progress: Progress | None, found: Recommendation, deadline: float
) -> Progress | None:
    """Tells beside the models who led the race, how likely, and when the time is up."""
    if progress is None:
        return None
    outcome = found.outcome
    leader = found.ranked["combination"][0]
    chance = likelihood(float(outcome.probability[outcome.order[0]]))
    tell = progress

    def told(event: Event) -> None:
        made = f"{event.done} of {event.total} {event.unit}" if event.total else event.stage
        standing = f"{leader} led the race ({chance}); {made}"
        tell(replace(event, ends=deadline, standing=standing))

    return told


def exactly_matched(combination: Combination) -> Combination:
    """The same with the exact matcher: the matches of brute force in a fraction of its time.

    Matchers that find other matches stay, but FLANN, which finds nearly the same.
    """
    if why_not_exact() or combination.matcher not in NEAREST:
        return combination
    return replace(combination, matcher=EXACT.name)


def scene_of_final(dataset: Dataset, survey: Survey | None, most: int = MOST_IMAGES) -> Dataset:
    """Images to build and their pairs: those that a survey saw overlap, else the dataset's own.

    Of more than so many images a connected block is taken.
    """
    if survey is None:
        return dataset
    names = set(survey.images)
    if len(names) > most:
        names = set(connected_block(survey, most))
    others = [each for each in dataset.settings if each[0] != "pairs"]
    return replace(
        dataset,
        images=[image for image in dataset.images if image.name in names],
        pairs=_pairs(survey, names, dataset.pairs),
        settings=(*others, ("pairs", "surveyed")),
    )


def _pairs(survey: Survey, names: set[str], own: Sequence[Pair]) -> list[Pair]:
    sequence = own[0].sequence
    found = [(survey.images[each.image_1], survey.images[each.image_2]) for each in survey.pairs]
    kept = [(first, second) for first, second in found if {first, second} <= names]
    return [Pair(number, *both, sequence) for number, both in enumerate(kept)]
