"""What the displays say, by a clock that the test turns."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass

import pytest

from aerocues.cli.live import LiveDisplay
from aerocues.cli.progress import PlainLines, Tally
from aerocues.evaluation.engine import Finished
from aerocues.evaluation.plan import Exclusion, Plan
from aerocues.evaluation.planned_rows import PlannedRow
from aerocues.evaluation.run_progress import RunProgress
from aerocues.evaluation.unit import PairWork, Unit
from aerocues.methods.combination import Combination
from aerocues.phrases import spoken_seconds
from aerocues.processes.call import StageCall
from aerocues.progress import Activity, Event, StageProgress


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
    run = RunProgress(tally)
    run.planned(PLAN, "shared")
    assert tally.seconds_left() is None
    assert tally.progress() == "60 of 100 rows (60 %), 0 s so far"
    clock.now += 60
    run.finished(done(DEAR))
    # 30 of 40 parts of the cost took 60 s: the rest takes 20.
    assert tally.progress() == "80 of 100 rows (80 %), 1 min 00 s so far, about 20 s left"
    clock.now += 5
    assert tally.seconds_left() == pytest.approx(15)
    clock.now += 60
    assert tally.seconds_left() == 0
    run.finished(done(CHEAP, "crashed"))
    (rows,) = tally.counted
    assert (rows.first, rows.added, rows.done, rows.total) == (60, 40, 100, 100)
    assert tally.outcomes() == "ok 20, crashed 20"
    assert tally.elapsed == 125


def test_plain_lines_come_at_most_every_ten_seconds(capsys: pytest.CaptureFixture[str]) -> None:
    clock = Clock()
    run = RunProgress(PlainLines(clock=clock))
    small = [unit(1, 1.0) for _ in range(100)]
    run.planned(plan_of(*small, rows=100), "shared")
    for one in small:
        clock.now += 0.5
        run.finished(done(one))
        run.watch([])
    printed = capsys.readouterr().err.splitlines()
    assert printed[0] == "100 rows to measure in 100 units of work"
    # 50 s, one line every 10 s, each at least a tenth further.
    assert [line.split()[0] for line in printed[1:]] == ["20", "40", "60", "80", "100"]


def test_plain_lines_come_each_minute_and_say_what_lasts_so_long(
    capsys: pytest.CaptureFixture[str],
) -> None:
    clock = Clock()
    run = RunProgress(PlainLines(clock=clock))
    run.planned(plan_of(DEAR, rows=20), "shared")
    call = StageCall("match", 0, "1.png and 2.png", "ORB", "ORB", "ORB-ORB-HAM-BF")
    for seconds in range(180):
        clock.now += 1
        run.watch([Activity(0, call, seconds), Activity(1, None, 0.0)])
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1 + 3
    assert lines[-1] == (
        "0 of 20 rows (0 %), 3 min 00 s so far; match ORB-ORB-HAM-BF on 1.png and 2.png"
    )


def test_plain_lines_say_at_once_and_each_minute_that_no_worker_is_there(
    capsys: pytest.CaptureFixture[str],
) -> None:
    clock = Clock()
    run = RunProgress(PlainLines(clock=clock))
    run.planned(plan_of(DEAR, rows=20), "shared")
    for seconds in range(130):
        clock.now += 1
        run.watch([Activity(0, None, seconds, "a worker with the resource board")])
    run.watch([Activity(0, None, 0.0)])
    clock.now += 1
    run.watch([Activity(0, None, 5.0, "a worker")])
    printed = capsys.readouterr().err.splitlines()[1:]
    assert [line.partition(";")[0] for line in printed] == [
        "waiting for a worker with the resource board, 0 s so far",
        "waiting for a worker with the resource board, 1 min 00 s so far",
        "waiting for a worker with the resource board, 2 min 00 s so far",
        "waiting for a worker, 5 s so far",
    ]
    assert printed[0].endswith("; 0 of 20 rows (0 %), 1 s so far")


def test_plain_lines_tell_now_and_then_how_things_stand(capsys: pytest.CaptureFixture[str]) -> None:
    clock = Clock()
    stage = StageProgress(PlainLines(clock=clock), "racing", "measurements", total=50)
    stage.tell(message="the race begins")
    for second in range(1, 31):
        clock.now += 1
        stage.tell(done=second, standing=f"{second} measurements, ORB leads")
    assert capsys.readouterr().err.splitlines() == [
        "the race begins",
        *(f"{second} measurements, ORB leads" for second in (10, 20, 30)),
    ]


def test_plain_lines_tell_which_pair_of_a_model_is_at_work(
    capsys: pytest.CaptureFixture[str],
) -> None:
    clock = Clock()
    stage = StageProgress(PlainLines(clock=clock), "reconstructing", "models", total=2)
    stage.tell()
    for pair in range(1, 18):
        clock.now += 5
        name = "GFTT_H-TEBLID-HAM-EXACT"
        call = StageCall("match", -1, "a and b", "GFTT_H", "TEBLID", name, pair, 17)
        stage.tell(workers=(Activity(0, call, 1.0),), share=pair / 34)
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == (
        "0 of 2 models, about 2 min 30 s left; match pair 4 of 17, GFTT_H-TEBLID-HAM-EXACT"
    )
    assert len(lines) == 4


def test_under_a_budget_a_line_comes_every_few_seconds(capsys: pytest.CaptureFixture[str]) -> None:
    clock = Clock()
    lines = PlainLines(clock=clock)
    ends = clock.now + 130
    stage = StageProgress(lines, "surveying the flight", "images and pairs", ends=ends)
    stage.count(1, 40)
    clock.now += 3
    stage.count(7, 40)
    clock.now += 1
    lines.tick()
    leads = "GFTT_H-TEBLID-HAM-FLANN leads (61%), 12 still in the race"
    racing = StageProgress(lines, "racing", "measurements", ends=ends)
    call = StageCall("match", 0, "1.png and 2.png", "ORB", "ORB", "ORB-ORB-HAM-BF", 5, 17)
    clock.now += 5
    racing.tell(standing=leads, workers=(Activity(0, call, 1.0),))
    clock.now += 200
    racing.tell(standing="racing", workers=(Activity(0, call, 1.0),))
    printed = capsys.readouterr().err.splitlines()
    assert printed == [
        "surveying the flight: 1 of 40 images and pairs, 2 min 10 s left",
        "surveying the flight: 7 of 40 images and pairs, 2 min 06 s left",
        f"{leads}, 2 min 01 s left",
        "racing, 0 s left; match pair 5 of 17, ORB-ORB-HAM-BF",
    ]
    assert max(map(len, printed)) <= 80


def test_the_live_display_shows_workers_rows_and_failures() -> None:
    from rich.console import Console

    clock = Clock()
    display = LiveDisplay(clock=clock)
    run = RunProgress(display)

    def shown() -> list[str]:
        console = Console(file=io.StringIO(), width=100, record=True)
        console.print(display.picture())
        return console.export_text().splitlines()

    run.read(3, 7)
    assert "reading images: 3 of 7 images (42 %)" in shown()[0]
    run.planned(PLAN, "shared")
    clock.now += 60
    run.finished(done(DEAR, "timeout"))
    call = StageCall("match", 0, "1.png and " + "long/" * 30, "ORB", "ORB", "ORB-ORB-HAM-BF")
    run.watch([Activity(0, call, 12.3), Activity(1, None, 0.0)])
    bar, first, second, outcomes = shown()
    assert "80 of 100 rows (80 %), 1 min 00 s so far, about 20 s" in bar
    assert first.startswith("worker 1  match ORB-ORB-HAM-BF on 1.png")
    assert len(first) == 100
    assert second.split() == ["worker", "2", "between", "two", "calls"]
    assert outcomes.split() == ["so", "far", "timeout", "20"]
    run.watch([Activity(0, None, 65.0, "a worker with the resource board")])
    assert shown()[1].strip() == "waiting for a worker with the resource board, 1 min 05 s so far"
    display(Event("racing", standing="ORB leads"))
    assert shown() == ["ORB leads"]


def on_a_screen(tell: Callable[[RunProgress], None]) -> str:
    """What a live display writes."""
    from rich.console import Console
    from rich.live import Live

    screen = io.StringIO()
    console = Console(file=screen, width=40, force_terminal=True, color_system=None)
    with Live(console=console, auto_refresh=False, transient=True) as live:
        tell(RunProgress(LiveDisplay(live=live)))
    return screen.getvalue()


@pytest.mark.parametrize("units", [(), (DEAR,)])
def test_what_images_rule_out_is_told_by_reason_even_where_nothing_is_left(
    units: tuple[Unit, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    plan = plan_of(*units, rows=20, exclusions=EXCLUSIONS)
    RunProgress(PlainLines()).planned(plan, "shared")
    assert capsys.readouterr().err.splitlines()[:2] == LEFT_OUT
    screen = on_a_screen(lambda run: run.planned(plan, "shared"))
    for line in LEFT_OUT:
        assert line in screen


def test_a_second_pass_is_told_apart_from_the_rows_that_are_there() -> None:
    tally = Tally()
    run = RunProgress(tally)
    assert tally.kept() == ""
    run.read(3, 3)
    assert tally.kept() == ""
    run.planned(PLAN, "estimated")
    assert tally.kept() == "60 of 100 rows are finished"
    run.finished(done(DEAR))
    run.finished(done(CHEAP))
    run.planned(plan_of(CHEAP, rows=20), "exclusive")
    assert tally.kept() == "100 of 100 rows, 0 of 20 rows timed alone are finished"
    run.finished(done(CHEAP))
    assert [each.added for each in tally.counted] == [40, 20]


def test_rows_that_count_no_longer_are_told_in_options(capsys: pytest.CaptureFixture[str]) -> None:
    RunProgress(PlainLines()).set_aside(1200)
    line = capsys.readouterr().err
    assert line.startswith("1,200 rows")
    assert "--output" in line


def test_an_event_in_one_line() -> None:
    assert str(Event("measuring", "rows", 1200, 13600)) == "measuring: 1,200 of 13,600 rows"
    assert str(Event("racing", standing="ORB leads")) == "racing: ORB leads"
    assert str(Event("racing", message="it begins")) == "racing: it begins"
    assert str(Event("racing")) == "racing"
