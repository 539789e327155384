"""How the evaluation of one combination on one pair can end: one row a status."""

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
    Status("ok", "a model was found and, where asked for, it beats chance"),
    Status("no_keypoints", "the detector found no keypoint in one of the images"),
    Status("no_descriptors", "the descriptor kept no keypoint in one of the images"),
    Status("too_few_matches", "fewer mutual matches than a model can be judged by"),
    Status("no_model", "robust estimation returned no valid fundamental matrix"),
    Status("chance", "the model is no better than those that shuffled matches give"),
    Status("error", "a method raised an error; the message has it", retried=True),
    Status("crashed", "the process died in a method; the message says in which", retried=True),
    Status("timeout", "a stage used up its time limit", retried=True),
    Status("out_of_memory", "a stage asked for more memory than the limit", retried=True),
)

RETRIED: tuple[str, ...] = tuple(status.name for status in STATUSES if status.retried)
