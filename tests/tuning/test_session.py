"""Races that are interrupted, go on and get more time, on a clock of their own."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from aerocues.datasets.catalog import open_dataset
from aerocues.errors import SelectionError
from aerocues.evaluation.context import make_context
from aerocues.evaluation.engine import Finished
from aerocues.evaluation.unit import Context, Unit
from aerocues.methods.presets import preset_named
from aerocues.methods.selection import select
from aerocues.progress import Watch
from aerocues.results.metrics import Row
from aerocues.results.store import Store
from aerocues.scoring.criteria import criteria_named
from aerocues.scoring.settings import score_preset_named
from aerocues.tuning.image_evaluator import ImageEvaluator
from aerocues.tuning.journal import Journal
from aerocues.tuning.pair_evaluator import PairEvaluator
from aerocues.tuning.race import RaceOutcome, RaceSettings, race
from aerocues.tuning.representative import find_overlap, probes
from aerocues.tuning.session import Session
from tests.evaluation.inline import InlineEngine

SOME = "ORB-ORB-HAM-BF,ORB-BRI*-HAM-BF,AKAZE-AKAZE-HAM-*,GFTT-BRIEF-*,STAR-SIFT-*"
SECONDS_A_ROW = 1.0
ENOUGH = 1000.0


@dataclass
class Machine:
    """Hands out rows that it measured once, each after a second of its clock; all times are alike.

    Parameters
    ----------
    memory : dict of str to Row
        Rows by their keys, those of other machines among them.
    rows_left : int
        After so many it is interrupted.
    """

    memory: dict[str, Row]
    rows_left: int = 10_000
    now: float = 0.0
    measured: list[str] = field(default_factory=list)

    def clock(self) -> float:
        return self.now

    def run(
        self, units: Sequence[Unit], context: Context, watch: Watch
    ) -> Generator[Finished, None, None]:
        for unit in units:
            keys = [key for work in unit.work for key in work.row_keys]
            if self.rows_left < len(keys):
                raise KeyboardInterrupt
            if not set(keys) <= set(self.memory):
                [finished] = InlineEngine().run([unit], context, watch)
                self.memory.update((str(row["row_key"]), timeless(row)) for row in finished.rows)
            self.now += SECONDS_A_ROW * len(keys)
            watch([])
            self.rows_left -= len(keys)
            self.measured += keys
            yield Finished(unit, [self.memory[key] for key in keys])


def timeless(row: Row) -> Row:
    """The row with the same time for everything, so that decisions depend on no machine."""
    return {
        name: 0.01 if "seconds" in name and isinstance(value, float) else value
        for name, value in row.items()
    }


@pytest.fixture(scope="session")
def memory() -> dict[str, Row]:
    return {}


def sit(photos: Path, folder: Path, machine: Machine, budget: float) -> RaceOutcome:
    """Race from where the folder stands."""
    preset = preset_named("default")
    dataset = open_dataset(str(photos), pairs="exhaustive")
    context = make_context(dataset, preset, timing="estimated")
    chosen = select(context.methods, SOME)
    asked = list(dict.fromkeys([*chosen, *probes()]))
    evaluator = PairEvaluator(context, asked, Store.create(folder), preset, clock=machine.clock)
    session = Session(Journal.read(folder, "race", budget), clock=machine.clock)
    seen = find_overlap(evaluator, machine, dataset.pairs, session)
    scoring = score_preset_named("default")
    criteria = criteria_named(scoring.criteria)
    criteria_evaluator = ImageEvaluator(
        evaluator, machine, chosen, seen.overlapping, criteria, session
    )
    settings = RaceSettings(budget, last_draws=50, batch=6, score=scoring.settings)
    return race(criteria_evaluator, settings, clock=machine.clock)


def assert_same(first: RaceOutcome, second: RaceOutcome) -> None:
    assert first.rounds == second.rounds
    assert first.ended == second.ended
    np.testing.assert_array_equal(first.known, second.known)
    np.testing.assert_array_equal(first.scores, second.scores)
    np.testing.assert_array_equal(first.probability, second.probability)


@pytest.mark.slow
@pytest.mark.parametrize("rows", [8, 33])
def test_an_interrupted_race_ends_as_one_that_was_not(
    photos: Path, tmp_path: Path, memory: dict[str, Row], rows: int
) -> None:
    whole = sit(photos, tmp_path / "whole", Machine(memory), budget=45.0)
    assert whole.ended == "budget"
    first = Machine(memory, rows_left=rows)
    with pytest.raises(KeyboardInterrupt):
        sit(photos, tmp_path / "parts", first, budget=45.0)
    second = Machine(memory, now=5000.0)
    assert_same(sit(photos, tmp_path / "parts", second, budget=45.0), whole)
    assert not set(first.measured) & set(second.measured)
    # Once it is finished, nothing is measured any more.
    third = Machine(memory)
    assert_same(sit(photos, tmp_path / "parts", third, budget=45.0), whole)
    assert not third.measured


@pytest.mark.slow
def test_more_budget_goes_on_and_measures_what_time_was_lacking_for(
    photos: Path, tmp_path: Path, memory: dict[str, Row]
) -> None:
    first, second = Machine(memory), Machine(memory)
    short = sit(photos, tmp_path / "race", first, budget=45.0)
    assert short.ended == "budget"
    late = {
        key for step in Journal.read(tmp_path / "race", "race", 45.0).steps for key in step.missing
    }
    assert late
    longer = sit(photos, tmp_path / "race", second, budget=ENOUGH)
    assert longer.ended == "measured"
    assert (longer.known | ~short.known).all()
    assert not set(first.measured) & set(second.measured)
    assert late <= set(second.measured)
    # What was spent counts: on the clock of the second sitting alone, less time went by.
    assert longer.rounds[-1].spent == pytest.approx(second.now + first.now, abs=10)
    # Whatever was asked for is there now: all those that may win, on all pairs.
    assert longer.known[longer.order[0]].all()
    whole = sit(photos, tmp_path / "whole", Machine(memory), budget=ENOUGH)
    assert whole.order[0] == longer.order[0]
    assert_same(sit(photos, tmp_path / "race", Machine(memory), budget=ENOUGH), longer)


@pytest.mark.slow
def test_short_time_looks_at_fewer_pairs(
    photos: Path, tmp_path: Path, memory: dict[str, Row]
) -> None:
    assert sit(photos, tmp_path / "some", Machine(memory), budget=20.0).known.shape[1] < 6
    assert sit(photos, tmp_path / "all", Machine(memory), budget=60.0).known.shape[1] == 6
    machine = Machine(memory)
    with pytest.raises(SelectionError, match=r"0 of 6 pairs.* `budget=.10s.`$"):
        sit(photos, tmp_path / "none", machine, budget=0.9)
    assert machine.now < 3
    with pytest.raises(SelectionError):
        sit(photos, tmp_path / "hardly", Machine(memory), budget=2.5)


def test_what_was_spent_before_a_race_counts(tmp_path: Path) -> None:
    journal = Journal.read(tmp_path, "race", 60.0)
    # The survey took 45 s: the test of overlap gets its share of the 15 that are left.
    assert Session(journal, began=100.0, clock=lambda: 145.0).spent == 45.0
    journal.add(["a"], 3.0, 0.0, [])
    assert Session(journal, began=100.0, clock=lambda: 145.0).spent == 0.0


def test_a_journal_is_followed_as_long_as_the_same_is_asked_for(tmp_path: Path) -> None:
    journal = Journal.read(tmp_path, "race", 10.0)
    journal.add(["a", "b"], 3.0, 0.0, [])
    journal.add(["c", "d"], 9.0, 1.0, ["d"])

    again = Journal.read(tmp_path, "race", 10.0)
    assert again.spent == 9.0
    step = again.replay(["a", "b"], ["a", "b", "c"])
    assert step is not None
    assert (step.spent, list(step.missing)) == (3.0, [])
    step = again.replay(["c", "d"], ["c"])
    assert step is not None
    assert list(step.missing) == ["d"]
    assert again.replay(["e"], ["e"]) is None

    other_way = Journal.read(tmp_path, "race", 10.0)
    assert other_way.replay(["a", "x"], ["a", "b"]) is None
    assert other_way.replay(["c", "d"], ["c"]) is None
    assert other_way.spent == 9.0
    lost = Journal.read(tmp_path, "race", 10.0)
    assert lost.replay(["a", "b"], ["a"]) is None

    more_time = Journal.read(tmp_path, "race", 20.0)
    assert more_time.replay(["a", "b"], ["a", "b"]) is not None
    assert more_time.replay(["c", "d"], ["c"]) is None
    assert more_time.spent == 9.0
    assert Journal.read(tmp_path, "another", 10.0).spent == 0.0


def test_a_journal_keeps_which_rows_were_there_when_it_began(tmp_path: Path) -> None:
    journal = Journal.read(tmp_path, "race", 10.0, ["a", "b"])
    journal.add(["c"], 3.0, 0.0, [])
    assert Journal.read(tmp_path, "race", 10.0, ["a", "b", "c"]).given == {"a", "b"}
    assert Journal.read(tmp_path, "race", 20.0, []).given == {"a", "b"}
    assert Journal.read(tmp_path, "another", 10.0, ["a", "c"]).given == {"a", "c"}
