from __future__ import annotations

from fnmatch import fnmatchcase

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aerocues.errors import SelectionError
from aerocues.methods.combination import Combination
from aerocues.methods.registry import Methods, opencv_methods
from aerocues.methods.selection import Asked, meaningful, runnable, select, select_measured

TEXTS = st.sampled_from([str(c) for c in meaningful(opencv_methods())])


def texts(chosen: list[Combination]) -> list[str]:
    return [str(combination) for combination in chosen]


def test_nothing_said_selects_the_meaningful_ones(methods: Methods) -> None:
    assert select(methods) == meaningful(methods)
    assert select(methods, "") == meaningful(methods)
    assert select(methods, everything=True) == runnable(methods)


def test_globs_select_in_any_case_and_in_the_order_of_the_tables(methods: Methods) -> None:
    chosen = texts(select(methods, "akaze-sift-*, orb-*-ham-bf"))
    expected = [
        text
        for text in texts(meaningful(methods))
        if fnmatchcase(text, "ORB-*-HAM-BF") or fnmatchcase(text, "AKAZE-SIFT-*")
    ]
    assert chosen == expected
    assert {"AKAZE-SIFT-L2-BF", "AKAZE-SIFT-L2-FLANN", "ORB-LUCID-HAM-BF"} <= set(chosen)
    assert chosen.index("AKAZE-SIFT-L2-BF") < chosen.index("ORB-ORB-HAM-BF")


def test_repeated_patterns_select_once(methods: Methods) -> None:
    assert texts(select(methods, "ORB-ORB-HAM-BF,ORB-ORB-HAM-BF,ORB-ORB-*-BF")) == [
        "ORB-ORB-HAM-BF"
    ]


def test_exclusion_takes_out(methods: Methods) -> None:
    chosen = texts(select(methods, "ORB-*-HAM-BF,!*-LATCH-*,!orb-boost-*"))
    everything = texts(select(methods, "ORB-*-HAM-BF"))
    assert set(everything) - set(chosen) == {"ORB-LATCH-HAM-BF", "ORB-BOOST-HAM-BF"}


def test_exclusion_alone_starts_from_the_usual_ones(methods: Methods) -> None:
    chosen = texts(select(methods, "!*-VGG-*"))
    assert chosen == [text for text in texts(meaningful(methods)) if "-VGG-" not in text]


def test_a_full_name_is_taken_even_where_it_means_nothing(methods: Methods) -> None:
    assert texts(select(methods, "ORB-ORB-L2-BF")) == ["ORB-ORB-L2-BF"]
    assert len(select(methods, "ORB-ORB-*", everything=True)) == 3
    assert len(select(methods, "ORB-ORB-*")) == 2


def test_detectors_and_descriptors_narrow_down(methods: Methods) -> None:
    chosen = select(methods, detectors="orb,gftt*", descriptors=["SIFT", "B?ISK"])
    assert {c.detector for c in chosen} == {"ORB", "GFTT", "GFTT_H"}
    assert {c.descriptor for c in chosen} == {"SIFT", "BRISK"}
    assert len(chosen) == 3 * 2 * 2


@pytest.mark.slow
@given(st.lists(TEXTS, min_size=1, max_size=5), st.lists(TEXTS, max_size=3))
def test_full_names_select_exactly_themselves(wanted: list[str], unwanted: list[str]) -> None:
    patterns = [*wanted, *(f"!{text}" for text in unwanted)]
    kept = set(wanted) - set(unwanted)
    if not kept:
        with pytest.raises(SelectionError, match="empty"):
            select(opencv_methods(), patterns)
    else:
        assert set(texts(select(opencv_methods(), ",".join(patterns)))) == kept


@pytest.mark.parametrize(
    ("patterns", "words"),
    [
        ("SIFT-ORB-HAM-BF", "72 GB"),
        ("*-AKAZE-L2-FLANN", "needs what only keypoints of AKAZE or KAZE carry"),
        ("ORB-*-L2-FLANN,SIFT-ORB-*", "selects nothing that can run"),
        ("ORB-ORB-L2-*", "everything=True"),
        ("ORB-BEBLIT-HAM-BF", "did you mean ORB-BEBLID-HAM-BF"),
        ("nonsense", "aerocues methods"),
        ("*PIXEL*", "on request, such as PIXELMAP-NONE-NONE-PIXELMAP; name them in full or add +e"),
        ("*RAT*", "name them in full or add +extra"),
        ("ORB-NONE*", "on request, such as ORB-NONE-NONE-PIXELMAP; name them in full"),
        ("ORB-ORB-HAM-BF,!ORB-*", "empty"),
    ],
)
def test_a_selection_of_nothing_says_why(methods: Methods, patterns: str, words: str) -> None:
    with pytest.raises(SelectionError) as raised:
        select(methods, patterns)
    assert words in str(raised.value)


def test_an_unknown_detector_or_descriptor_says_which_there_are(methods: Methods) -> None:
    with pytest.raises(SelectionError, match=r"detector SURF\b.*SIFT, AKAZE"):
        select(methods, detectors="SURF")
    with pytest.raises(SelectionError, match="descriptor SURF"):
        select(methods, descriptors="ORB,SURF")


def test_the_own_name_of_a_pair_matcher_takes_it_out(methods: Methods) -> None:
    asked = Asked.of("!pixelmap", methods)
    assert asked.leaves_out(Combination.of_pair_matcher("PIXELMAP"))
    assert not asked.leaves_out(Combination("ORB", "NONE", "NONE", "PIXELMAP"))


MEASURED = [
    *("SIFT-SIFT-L2-BF", "ORB-ORB-HAM-BF", "ORB-ORB-HAM-GMS"),
    *("PIXELMAP-NONE-NONE-PIXELMAP", "ORB-NONE-NONE-PIXELMAP", "COLMAP-SIFT-L2-COLMAP"),
]


@pytest.mark.parametrize(
    ("patterns", "taken"),
    [
        ("*", [0, 1, 2, 3, 4, 5]),
        ("*,!SIFT-*", [1, 2, 3, 4, 5]),
        ("!sift-*", [1, 2, 3, 4, 5]),
        ("PixelMap", [3]),
        ("*,!PIXELMAP", [0, 1, 2, 4, 5]),
        ("ORB-*-BF,+extra", [1]),
        ("+extra", [0, 1, 2, 3, 4, 5]),
        (Combination("ORB", "ORB", "HAM", "BF"), [1]),
    ],
)
def test_measured_combinations_are_chosen_by_the_same_patterns(
    methods: Methods, patterns: str | Combination, taken: list[int]
) -> None:
    assert select_measured(methods, patterns, MEASURED) == [MEASURED[each] for each in taken]


@pytest.mark.parametrize("patterns", ["NOPE", "ORB-*,AKAZE-*", "+nothing"])
def test_a_pattern_that_nothing_measured_matches_is_an_error(
    methods: Methods, patterns: str
) -> None:
    with pytest.raises(SelectionError, match=r"no measured combination|no set"):
        select_measured(methods, patterns, MEASURED)
