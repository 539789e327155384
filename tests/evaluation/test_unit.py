from __future__ import annotations

from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aerocues.evaluation.unit import PairWork, Unit, split
from aerocues.methods.combination import Combination
from aerocues.processes.call import StageCall

DESCRIPTORS = ("ORB", "BRISK", "SIFT")
COMBINATIONS = [
    Combination("ORB", descriptor, norm, matcher)
    for descriptor in DESCRIPTORS
    for norm in ("L2", "HAM")
    for matcher in ("BF", "FLANN")
]


def work(pair: int, combinations: list[Combination]) -> PairWork:
    return PairWork(pair, tuple(combinations), tuple(f"{pair}/{c}" for c in combinations))


def keys(*units: Unit) -> Counter[str]:
    return Counter(key for unit in units for part in unit.work for key in part.row_keys)


@st.composite
def units(draw: st.DrawFn) -> Unit:
    pairs = draw(st.lists(st.integers(0, 30), min_size=1, max_size=6, unique=True))
    chosen = st.lists(st.sampled_from(COMBINATIONS), min_size=1, unique=True)
    return Unit("ORB", tuple(work(pair, draw(chosen)) for pair in pairs), draw(st.floats(0, 1e3)))


@st.composite
def calls(draw: st.DrawFn) -> StageCall | None:
    if draw(st.booleans()) and draw(st.booleans()):
        return None
    combination = draw(st.sampled_from(COMBINATIONS))
    stage = draw(st.sampled_from(["reference", "detect", "describe", "match", "verify"]))
    descriptor = "" if stage in ("reference", "detect") else combination.descriptor
    named = str(combination) if stage in ("match", "verify") else ""
    return StageCall(stage, draw(st.integers(0, 30)), "image", "ORB", descriptor, named)


@given(units(), calls(), st.booleans(), st.none() | st.frozensets(st.integers(0, 30)))
def test_splitting_never_loses_or_doubles_a_row(
    unit: Unit, call: StageCall | None, certain: bool, pairs: frozenset[int] | None
) -> None:
    remaining, guilty = split(unit, call, certain=certain, pairs=pairs)
    parts = [*remaining, *([guilty] if guilty else [])]
    assert keys(*parts) == keys(unit)
    assert all(part.rows for part in remaining)
    for part in parts:
        for piece in part.work:
            assert [f"{piece.pair}/{c}" for c in piece.combinations] == list(piece.row_keys)


@given(units(), st.data())
def test_splitting_comes_to_an_end(unit: Unit, data: st.DataObject) -> None:
    """Whatever a worker dies in, time after time, every row is given up or done at last."""
    queue, settled, deaths = [unit], Counter[str](), 0
    while queue:
        part = queue.pop()
        if data.draw(st.booleans()):
            settled += keys(part)
            continue
        deaths += 1
        remaining, guilty = split(part, data.draw(calls()), certain=data.draw(st.booleans()))
        queue += remaining
        if guilty:
            settled += keys(guilty)
    assert settled == keys(unit)
    assert deaths <= unit.rows + 2 * len(unit.work)


def test_the_pair_in_which_a_process_died_is_tried_once_more_alone() -> None:
    unit = Unit("ORB", tuple(work(pair, COMBINATIONS[:2]) for pair in (3, 4, 5, 6)), 8.0)
    remaining, guilty = split(unit, StageCall("detect", 4, "b", "ORB"), certain=False)
    assert guilty is None
    assert [[w.pair for w in part.work] for part in remaining] == [[4], [3], [5, 6]]
    assert [part.cost for part in remaining] == [2, 2, 4]
    assert all(part.alone for part in remaining)
    again, guilty = split(remaining[0], StageCall("detect", 4, "b", "ORB"), certain=False)
    assert not again
    assert guilty is not None
    assert keys(guilty) == keys(remaining[0])


def test_a_stage_that_used_up_its_time_is_given_up_at_once() -> None:
    unit = Unit("ORB", tuple(work(pair, COMBINATIONS[:2]) for pair in (3, 4, 5)))
    remaining, guilty = split(unit, StageCall("detect", 4, "b", "ORB"), certain=True)
    assert [[w.pair for w in part.work] for part in remaining] == [[3, 5]]
    assert guilty is not None
    assert [w.pair for w in guilty.work] == [4]


def test_every_pair_that_needs_the_image_is_given_up_with_it() -> None:
    unit = Unit("ORB", tuple(work(pair, COMBINATIONS) for pair in (3, 4, 5)))
    image = frozenset({4, 5, 9})
    call = StageCall("detect", 4, "b", "ORB")
    remaining, guilty = split(unit, call, certain=True, pairs=image)
    assert [[w.pair for w in part.work] for part in remaining] == [[3]]
    assert guilty is not None
    assert [w.pair for w in guilty.work] == [4, 5]
    call = StageCall("describe", 4, "b", "ORB", "BRISK")
    remaining, guilty = split(unit, call, certain=True, pairs=image)
    assert guilty is not None
    assert keys(guilty) == keys(
        Unit("ORB", (work(4, COMBINATIONS[4:8]), work(5, COMBINATIONS[4:8])))
    )
    assert keys(*remaining, guilty) == keys(unit)


@pytest.mark.parametrize(
    ("call", "given_up"),
    [
        (StageCall("detect", 4, "b", "ORB"), COMBINATIONS),
        (StageCall("describe", 4, "b", "ORB", "BRISK"), COMBINATIONS[4:8]),
        (
            StageCall("match", 4, "a and b", "ORB", "BRISK", "ORB-BRISK-HAM-BF"),
            [Combination.parse("ORB-BRISK-HAM-BF")],
        ),
        (
            StageCall("verify", 4, "a and b", "ORB", "ORB", "ORB-ORB-L2-FLANN"),
            [Combination.parse("ORB-ORB-L2-FLANN")],
        ),
        (None, COMBINATIONS),
        (StageCall("match", 9, "x", "ORB", "ORB", "ORB-ORB-L2-FLANN"), COMBINATIONS),
    ],
)
def test_only_what_depends_on_the_call_is_given_up(
    call: StageCall | None, given_up: list[Combination]
) -> None:
    remaining, guilty = split(Unit("ORB", (work(4, COMBINATIONS),)), call, certain=True)
    assert guilty is not None
    assert list(guilty.work[0].combinations) == given_up
    left = [c for part in remaining for c in part.work[0].combinations]
    assert left == [c for c in COMBINATIONS if c not in given_up]


def test_a_reference_that_cannot_be_built_costs_its_pair_alone() -> None:
    unit = Unit("ORB", tuple(work(pair, COMBINATIONS[:2]) for pair in (3, 4, 5)), 6.0)
    call = StageCall("reference", 4, "a and b", "flow")
    remaining, guilty = split(unit, call, certain=True)
    assert guilty is not None
    assert [part.pair for part in guilty.work] == [4]
    assert guilty.rows == 2
    assert sorted(part.pair for each in remaining for part in each.work) == [3, 5]
