"""Handles units whose process or machine was lost."""

from __future__ import annotations

from aerocues.datasets.dataset import Dataset
from aerocues.evaluation.engine import Finished
from aerocues.evaluation.rows import failed_rows
from aerocues.evaluation.unit import Context, Unit, split
from aerocues.processes.call import StageCall
from aerocues.processes.child_process import Loss


def settle_loss(context: Context, unit: Unit, loss: Loss) -> tuple[Finished | None, list[Unit]]:
    """Divide a lost unit into a part that is given up and parts to retry.

    Returns
    -------
    given_up : Finished or None
        The rows of the work that caused `loss`, if that is certain.
    remaining : list of Unit
        Parts to retry, each in its own process.
    """
    remaining, guilty = split(
        unit,
        loss.call,
        certain=loss.status != "crashed",
        pairs=_pairs_of(context.dataset, loss.call),
    )
    if guilty is None:
        return None, remaining
    return Finished(guilty, failed_rows(context, guilty, loss.status, loss.message)), remaining


def _pairs_of(dataset: Dataset, call: StageCall | None) -> frozenset[int] | None:
    """The pairs that need the features of the image of a call; None if the call is about a pair."""
    if call is None or call.stage not in ("detect", "describe"):
        return None
    return frozenset(
        pair.index for pair in dataset.pairs if call.image in (pair.image_1, pair.image_2)
    )
