"""Possible outcomes of one combination on one pair: one row per status."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Status:
    """One outcome.

    ``retried`` says whether ``retry_failed`` runs such a row again: where the machine or a
    method's bug decided, not the images.
    """

    name: str
    meaning: str
    retried: bool = False


STATUSES: tuple[Status, ...] = (
    Status("ok", "a model was found and, if required, it beats chance"),
    Status("no_keypoints", "the detector found no keypoints in one of the images"),
    Status("no_descriptors", "the descriptor kept no keypoints in one of the images"),
    Status("too_few_matches", "too few mutual matches to estimate and judge a model"),
    Status("no_model", "robust estimation returned no valid fundamental matrix"),
    Status(
        "chance",
        "the model is not better than models of shuffled matches, or almost none of its inliers "
        "are right according to the reference of the pair",
    ),
    Status("error", "a method raised an error; see the message", retried=True),
    Status("crashed", "the process died in a method; the message names the method", retried=True),
    Status("timeout", "a stage exceeded its time limit", retried=True),
    Status("out_of_memory", "a stage exceeded the memory limit", retried=True),
)

RETRIED: tuple[str, ...] = tuple(status.name for status in STATUSES if status.retried)
