"""What the displays say, by a clock that the test turns."""

from __future__ import annotations

import io
from dataclasses import dataclass

import pytest

from aerocues.cli.live import LiveDisplay
from aerocues.cli.progress import PlainLines, Tally, spoken_seconds
from aerocues.evaluation.engine import Activity, Finished
from aerocues.evaluation.plan import Exclusion, Plan
from aerocues.evaluation.planned_rows import PlannedRow
from aerocues.evaluation.unit import PairWork, Unit
from aerocues.methods.combination import Combination
from aerocues.processes.call import StageCall


@dataclass
class Clock:
    now: float = 1000.0

    def __call__(self) -> float:
        return self.now


def unit(rows: int, cost: float) -> Unit:
    combination = Combination("ORB", "ORB", "HAM", "BF")
    keys = tuple(str(number) for number in range(rows))
    return Unit("ORB", (PairWork(0, (combination,) * rows, keys),), cost)


def done(of: Unit, status: str = "ok") -> Finished:
    return Finished(of, [{"status": status}] * of.rows)


def plan_of(*units: Unit, rows: int, exclusions: tuple[Exclusion, ...] = ()) -> Plan:
    """A plan of `rows` rows; those that no unit measures are there already."""
    planned = (PlannedRow(0, Combination("ORB", "ORB", "HAM", "BF"), str(i)) for i in range(rows))
    return Plan(units, tuple(planned), exclusions)


DEAR, CHEAP = unit(20, 30.0), unit(20, 10.0)
PLAN = plan_of(DEAR, CHEAP, rows=100)


def ruled_out(combination: str, reason: str, pairs: int) -> Exclusion:
    return Exclusion(Combination.parse(combination), reason, pairs)


EXCLUSIONS = (
    ruled_out("ORB-LUCID-HAM-BF", "images are gray", 3),
    ruled_out("ORB-FREAK-HAM-BF", "images are small", 1),
    ruled_out("BRISK-LUCID-HAM-BF", "images are gray", 2),
)
LEFT_OUT = [
    "left out: 2 combinations on 3 pairs, because images are gray",
    "left out: 1 combination on 1 pair, because images are small",
]


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.2, "0 s"), (59.4, "59 s"), (59.6, "1 min 00 s"), (245, "4 min 05 s"), (7800, "2 h 10 min")],
)
def test_spans_of_time_are_spoken(seconds: float, text: str) -> None:
    assert spoken_seconds(seconds) == text


def test_rows_that_were_there_count_and_cost_tells_the_time_left() -> None:
    clock = Clock()
    tally = Tally(clock=clock)
    tally.planned(PLAN, "shared")
    assert tally.seconds_left() is None
    assert tally.progress() == "60 of 100 rows (60 %), 0 s so far"
    clock.now += 60
    tally.finished(done(DEAR))
    # 30 of 40 parts of the cost took 60 s: the rest takes 20.
    assert tally.progress() == "80 of 100 rows (80 %), 1 min 00 s so far, about 20 s left"
    clock.now += 5
    assert tally.seconds_left() == pytest.approx(15)
    clock.now += 60
    assert tally.seconds_left() == 0
    tally.finished(done(CHEAP, "crashed"))
    assert (tally.rows_measured, tally.rows_stored, tally.share) == (40, 100, 1.0)
    assert tally.outcomes() == "ok 20, crashed 20"


def test_a_plan_without_rows_is_done() -> None:
    tally = Tally()
    assert tally.share == 1.0
    tally.planned(plan_of(rows=0), "shared")
    assert tally.share == 1.0


def test_plain_lines_come_at_most_every_ten_seconds(capsys: pytest.CaptureFixture[str]) -> None:
    clock = Clock()
    lines = PlainLines(clock=clock)
    small = [unit(1, 1.0) for _ in range(100)]
    lines.planned(plan_of(*small, rows=100), "shared")
    for one in small:
        clock.now += 0.5
        lines.finished(done(one))
        lines.working([])
    printed = capsys.readouterr().err.splitlines()
    assert printed[0] == "100 rows to measure in 100 units of work"
    # 50 s, one line every 10 s, each at least a tenth further.
    assert [line.split()[0] for line in printed[1:]] == ["20", "40", "60", "80", "100"]


def test_plain_lines_come_each_minute_even_where_nothing_moves(
    capsys: pytest.CaptureFixture[str],
) -> None:
    clock = Clock()
    lines = PlainLines(clock=clock)
    lines.planned(plan_of(DEAR, rows=20), "shared")
    for _ in range(180):
        clock.now += 1
        lines.working([])
    assert len(capsys.readouterr().err.splitlines()) == 1 + 3


def test_plain_lines_say_at_once_and_each_minute_that_no_worker_is_there(
    capsys: pytest.CaptureFixture[str],
) -> None:
    clock = Clock()
    lines = PlainLines(clock=clock)
    lines.planned(plan_of(DEAR, rows=20), "shared")
    for seconds in range(130):
        clock.now += 1
        lines.working([Activity(0, None, seconds, "a worker with the resource board")])
    lines.working([Activity(0, None, 0.0)])
    clock.now += 1
    lines.working([Activity(0, None, 5.0, "a worker")])
    printed = capsys.readouterr().err.splitlines()[1:]
    assert [line.partition(";")[0] for line in printed] == [
        "waiting for a worker with the resource board, 0 s so far",
        "waiting for a worker with the resource board, 1 min 00 s so far",
        "waiting for a worker with the resource board, 2 min 00 s so far",
        "waiting for a worker, 5 s so far",
    ]
    assert printed[0].endswith("; 0 of 20 rows (0 %), 1 s so far")


def test_the_live_display_shows_workers_rows_and_failures() -> None:
    from rich.console import Console

    clock = Clock()
    display = LiveDisplay(clock=clock)

    def shown() -> list[str]:
        console = Console(file=io.StringIO(), width=100, record=True)
        console.print(display.picture())
        return console.export_text().splitlines()

    display.hashing(3, 7)
    assert shown() == ["reading images: 3 of 7"]
    display.planned(PLAN, "shared")
    clock.now += 60
    display.finished(done(DEAR, "timeout"))
    call = StageCall("match", 0, "1.png and " + "long/" * 30, "ORB", "ORB", "ORB-ORB-HAM-BF")
    display.working([Activity(0, call, 12.3), Activity(1, None, 0.0)])
    bar, first, second, outcomes = shown()
    assert "80 of 100 rows (80 %), 1 min 00 s so far, about 20 s left" in bar
    assert first.startswith("worker 1  match ORB-ORB-HAM-BF on 1.png")
    assert len(first) == 100
    assert second.split() == ["worker", "2", "between", "two", "units"]
    assert outcomes.split() == ["so", "far", "timeout", "20"]
    display.working([Activity(0, None, 65.0, "a worker with the resource board")])
    assert shown()[1].strip() == "waiting for a worker with the resource board, 1 min 05 s so far"


@pytest.mark.parametrize("units", [(), (DEAR,)])
def test_what_images_rule_out_is_told_by_reason_even_where_nothing_is_left(
    units: tuple[Unit, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    from rich.console import Console
    from rich.live import Live

    PlainLines().planned(plan_of(*units, rows=20, exclusions=EXCLUSIONS), "shared")
    assert capsys.readouterr().err.splitlines()[:2] == LEFT_OUT
    screen = io.StringIO()
    console = Console(file=screen, width=40, force_terminal=True, color_system=None)
    with Live(console=console, auto_refresh=False, transient=True) as live:
        LiveDisplay(live=live).planned(plan_of(*units, rows=20, exclusions=EXCLUSIONS), "shared")
    for line in LEFT_OUT:
        assert line in screen.getvalue()


def test_a_second_pass_is_told_apart_from_the_rows_that_are_there() -> None:
    clock = Clock()
    tally = Tally(clock=clock)
    tally.planned(PLAN, "estimated")
    assert tally.stored() == "60 rows are stored"
    tally.finished(done(DEAR))
    tally.finished(done(CHEAP))
    assert tally.measured() == "measured 40 rows"
    tally.planned(plan_of(CHEAP, rows=20), "exclusive")
    assert tally.stored() == "100 rows are stored, 0 of 20 timed alone"
    tally.finished(done(CHEAP))
    assert tally.stored() == "100 rows are stored, 20 of 20 timed alone"
    assert tally.measured() == "measured 40 rows and timed 20 alone"
    assert tally.there_already() == "all 100 rows are there already, 20 of them timed alone"


def test_rows_that_count_no_longer_are_told(capsys: pytest.CaptureFixture[str]) -> None:
    PlainLines().set_aside(1200)
    assert "1,200 rows" in capsys.readouterr().err
