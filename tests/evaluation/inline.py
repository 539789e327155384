"""An engine in the calling process: quick, and of no help against what a method does to it."""

from __future__ import annotations

from collections.abc import Generator, Sequence

from aerocues.evaluation.engine import Finished
from aerocues.evaluation.evaluator import Evaluator
from aerocues.evaluation.unit import Context, Unit
from aerocues.progress import Watch


class InlineEngine:
    """Runs units one after the other."""

    def run(
        self, units: Sequence[Unit], context: Context, watch: Watch
    ) -> Generator[Finished, None, None]:
        evaluator = Evaluator(context, lambda call: None)
        for unit in units:
            yield Finished(unit, [row for rows in evaluator.evaluate(unit) for row in rows])
