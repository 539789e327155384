"""`aerocues methods`: the list, the choice and the reasons."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Call
from tests.methods.distribution import write_distribution


def test_the_figures_of_opencv(call: Call) -> None:
    facts = json.loads(call("methods", "--json").out)["opencv"]
    figures = {name: facts[name] for name in ("declared", "runnable", "meaningful")}
    assert figures == {"declared": 784, "runnable": 467, "meaningful": 340}
    assert sorted(facts["incompatible"].values()) == [8, 86, 96, 127]
    assert facts["declared"] == facts["runnable"] + sum(facts["incompatible"].values())


def test_every_method_is_listed_with_its_source(call: Call) -> None:
    facts = json.loads(call("methods", "--json").out)
    text = call("methods").out
    methods = [*facts["detectors"], *facts["descriptors"]]
    assert len(methods) >= 28
    for method in methods:
        assert {"name", "parameters", "origin", "reference", "unavailable"} <= method.keys()
        assert method["name"] in text
    assert facts["detectors"][0]["parameters"]["nfeatures"] == 30000
    assert [row["name"] for row in facts["norms"]] == ["L2", "HAM"]
    assert [row["name"] for row in facts["matchers"]][:2] == ["BF", "FLANN"]
    assert f"{facts['meaningful']}  of these" in text
    assert all(line == line.rstrip() for line in text.splitlines())


def test_a_preset_is_named_and_must_exist(call: Call) -> None:
    assert json.loads(call("methods", "--preset", "thesis", "--json").out)["preset"] == "thesis"
    assert call("methods", "--preset", "nothing").code == 2


def test_what_is_wrong_with_plug_ins_is_told_and_stops_nothing(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert json.loads(call("methods", "--json").out)["problems"] == []
    offered = {"detectors": {"orb": "unfit_here:Orb", "Odd-Name": "unfit_here:Orb"}}
    write_distribution(tmp_path, "unfit-here", offered, {"unfit_here.py": ""})
    monkeypatch.syspath_prepend(tmp_path)
    problems = json.loads(call("methods", "--json").out)["problems"]
    assert len(problems) == 2
    text = " ".join(call("methods").out.split())
    for problem in problems:
        assert problem in text
    assert call("methods", "why", "orb-orb-ham-bf").out == "ORB-ORB-HAM-BF runs\n"


@pytest.mark.parametrize(
    ("combination", "answer"),
    [
        ("sift-sift-l2-bf", "SIFT-SIFT-L2-BF runs\n"),
        ("SIFT-ORB-HAM-BF", "SIFT-ORB-HAM-BF cannot run: "),
        ("ORB-KAZE-L2-BF", "ORB-KAZE-L2-BF cannot run: "),
        ("SIFT-SIFT-HAM-BF", "SIFT-SIFT-HAM-BF cannot run: "),
        ("ORB-ORB-L2-FLANN", "ORB-ORB-L2-FLANN cannot run: "),
        ("ORB-ORB-L2-BF", "ORB-ORB-L2-BF runs but "),
        ("ORB-LUCID-HAM-BF", "ORB-LUCID-HAM-BF runs; "),
    ],
)
def test_why(call: Call, combination: str, answer: str) -> None:
    given = call("methods", "why", combination)
    assert given.code == 0
    assert given.out.startswith(answer)
    assert given.out.count("\n") == 1


@pytest.mark.parametrize(
    ("combination", "told"),
    [
        ("ORB-BEBLIT-HAM-BF", "BEBLID or TEBLID"),
        ("ORB-ORB-COSINE-BF", "L2, HAM"),
        ("ORBORB", "DETECTOR-DESCRIPTOR-NORM-MATCHER"),
        ("sift-sift", "SIFT-SIFT-L2-BF, SIFT-SIFT-L2-FLANN"),
        ("SIFT", "aerocues methods list --all 'SIFT-*'"),
    ],
)
def test_why_with_unknown_names(call: Call, combination: str, told: str) -> None:
    given = call("methods", "why", combination)
    assert given.code == 2
    assert told in given.err


def test_the_choice_is_listed_one_a_line(call: Call) -> None:
    assert len(call("methods", "list").out.split()) >= 340
    assert call("methods", "list", "orb-orb-*").out.split() == [
        "ORB-ORB-HAM-BF",
        "ORB-ORB-HAM-FLANN",
    ]
    narrowed = call("methods", "list", "--all", "--detectors", "ORB", "--descriptors", "ORB").out
    assert narrowed.split() == ["ORB-ORB-L2-BF", "ORB-ORB-HAM-BF", "ORB-ORB-HAM-FLANN"]
    assert call("methods", "list", "nothing").code == 2
