"""What decides the rows of a run besides images and combinations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from aerocues.arguments import check_choice, check_whole
from aerocues.datasets.dataset import Dataset
from aerocues.defaults import RACE_PAIRS, TIMED_PAIRS
from aerocues.errors import ArgumentError
from aerocues.evaluation.context import make_context
from aerocues.evaluation.footing import footing_wanted, preset_at_footing
from aerocues.evaluation.passes import Pass, passes
from aerocues.evaluation.run_progress import RunProgress
from aerocues.evaluation.unit import Context
from aerocues.methods.combination import Combination
from aerocues.methods.presets import Preset, as_preset
from aerocues.methods.strongest import KeypointLimit
from aerocues.pipeline.flight_pairs import survey_flight, surveyed
from aerocues.pipeline.upright import turned_as_surveyed
from aerocues.results.store import Store
from aerocues.results.timing import TIMINGS, Timing

FEWEST_SURVEYED = 5
"""Fewer images are too short a flight to turn round; consecutive pairs show all there is."""


@dataclass(frozen=True)
class RunSettings:
    """What decides the rows of a run and their times besides images and combinations."""

    preset: str | Preset
    seed: int
    timing: Timing
    timing_pairs: int | None
    limit: KeypointLimit
    upright: bool = False
    equal_footing: bool | None = None

    def __post_init__(self) -> None:
        check_choice("timing", self.timing, TIMINGS)
        check_whole("seed", self.seed, 0)
        footing_wanted(self.parts, self.limit, self.equal_footing)
        if self.timing_pairs is None:
            return
        check_whole("timing_pairs", self.timing_pairs, 0)
        if self.timing != "exclusive":
            raise ArgumentError(
                "`timing_pairs` is for pairs that are timed alone, and "
                f'`timing="{self.timing}"` times none so; leave one of the two out'
            )

    @cached_property
    def parts(self) -> Preset:
        """The preset."""
        return as_preset(self.preset)

    def context(self, dataset: Dataset) -> Context:
        """What all units share."""
        return make_context(
            dataset, self.parts, seed=self.seed, timing=self.timing, limit=self.limit
        )

    def with_thresholds(
        self,
        chosen: Sequence[Combination],
        dataset: Dataset,
        told: RunProgress,
        store: Store | None,
    ) -> RunSettings:
        """The settings with lowered thresholds of detectors, if `equal_footing` asks for these."""
        if not footing_wanted(self.parts, self.limit, self.equal_footing):
            return self
        methods = self.context(dataset).methods
        lowered = preset_at_footing(
            *(self.parts, methods, dataset, chosen, self.limit),
            seed=self.seed,
            told=told,
            store=store,
        )
        return replace(self, preset=lowered, equal_footing=False)

    def measured(
        self, dataset: Dataset, told: RunProgress, store: Store | None, *, keep: bool = True
    ) -> Dataset:
        """A flight whose pairs nobody chose, with pairs that stand for it; others as they are.

        The preset of the thesis keeps the consecutive pairs. Images are turned if that is asked
        for.
        """
        folder, survey = store.surveys if store else None, None
        if self.upright:
            survey = surveyed(dataset, self.seed, told.surveyed, folder, keep=keep)
            dataset = turned_as_surveyed(dataset, survey)
            told.note(dataset.notes[-1])
        if not self.parts.chance_test or len(dataset.images) < FEWEST_SURVEYED:
            return dataset
        flight = survey_flight(
            dataset, RACE_PAIRS, self.seed, told.surveyed, folder, keep=keep, survey=survey
        )
        for note in flight.notes() if flight else ():
            told.note(note)
        return flight.dataset if flight else dataset

    def passes(self, dataset: Dataset) -> tuple[Pass, ...]:
        """The passes over the pairs."""
        timed = TIMED_PAIRS if self.timing_pairs is None else self.timing_pairs
        return passes(dataset.pairs, self.timing, timed, self.seed)
