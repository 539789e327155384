from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from aerocues.datasets.dataset import Dataset, Pair
from aerocues.errors import ImageError
from aerocues.evaluation.plan import Plan, make_plan
from aerocues.evaluation.unit import Context
from aerocues.methods.combination import Combination
from aerocues.methods.presets import Preset
from aerocues.methods.registry import opencv_methods
from aerocues.methods.selection import meaningful, select
from aerocues.pipeline.protocol import MeasurementProtocol
from aerocues.results.hashing import content_hash
from tests.evaluation.scenes import dataset_of, strip, write_dataset

METHODS = opencv_methods()
SOME = select(METHODS, "ORB-ORB-*,ORB-LUCID-HAM-BF,SIFT-SIFT-L2-BF,AKAZE-SIFT-L2-BF")


def context_of(dataset: Dataset, protocol: MeasurementProtocol | None = None) -> Context:
    chosen = protocol or MeasurementProtocol()
    key = content_hash(["default", chosen.identity(), "4.x"])
    return Context(dataset, METHODS, "default", chosen, key, "a machine")


def plan_of(context: Context, combinations: list[Combination] = SOME) -> Plan:
    return make_plan(context, combinations, lambda key: False)


def keys(plan: Plan) -> Counter[str]:
    return Counter(key for unit in plan.units for work in unit.work for key in work.row_keys)


def named_keys(plan: Plan) -> dict[tuple[int, str], str]:
    return {
        (work.pair, str(combination)): key
        for unit in plan.units
        for work in unit.work
        for combination, key in zip(work.combinations, work.row_keys, strict=True)
    }


def test_units_cover_each_row_exactly_once(views: Dataset) -> None:
    combinations = meaningful(METHODS)
    plan = plan_of(context_of(views), combinations)
    assert plan.rows_planned == plan.rows_left == len(views.pairs) * len(combinations)
    assert set(named_keys(plan)) == {
        (pair.index, str(combination)) for pair in views.pairs for combination in combinations
    }
    assert set(keys(plan).values()) == {1}
    assert all(
        combination.detector == unit.detector
        for unit in plan.units
        for work in unit.work
        for combination in work.combinations
    )


def test_the_costliest_units_come_first(views: Dataset) -> None:
    plan = plan_of(context_of(views), meaningful(METHODS))
    costs = [unit.cost for unit in plan.units]
    assert costs == sorted(costs, reverse=True)
    assert min(costs) > 0


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(st.lists(st.sampled_from(["a", "b"]), min_size=1, max_size=25))
def test_units_are_short_runs_of_pairs_of_one_sequence(
    views: Dataset, sequences: list[str]
) -> None:
    first, second = views.images[0].name, views.images[1].name
    pairs = [Pair(i, first, second, name) for i, name in enumerate(sequences)]
    plan = plan_of(context_of(replace(views, pairs=pairs)), SOME[:1])
    for unit in plan.units:
        numbers = [work.pair for work in unit.work]
        assert len(numbers) <= 5
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
        assert len({sequences[number] for number in numbers}) == 1
    assert sorted(work.pair for unit in plan.units for work in unit.work) == list(
        range(len(sequences))
    )


def test_what_is_present_is_left_out(views: Dataset) -> None:
    context = context_of(views)
    everything = sorted(keys(plan_of(context)))
    there = frozenset(everything[::3])
    plan = make_plan(context, SOME, there.__contains__)
    assert sorted(keys(plan)) == sorted(set(everything) - there)
    assert plan.rows_present == len(there)
    assert plan.rows_planned == len(everything)
    assert make_plan(context, SOME, lambda key: True).units == ()


def test_the_same_work_has_the_same_keys(views: Dataset) -> None:
    context = context_of(views)
    forth = named_keys(plan_of(context))
    back = named_keys(plan_of(context, SOME[::-1]))
    assert forth == back


def test_timing_and_machine_do_not_change_keys(views: Dataset) -> None:
    shared = named_keys(plan_of(context_of(views)))
    exclusive = context_of(views, MeasurementProtocol(timing="exclusive"))
    assert named_keys(plan_of(replace(exclusive, machine="another"))) == shared


def test_names_and_numbers_do_not_change_keys(tmp_path: Path) -> None:
    pictures = strip(3)
    first = write_dataset(tmp_path / "one", pictures)
    renamed = {f"renamed_{name}": picture for name, picture in pictures.items()}
    second = write_dataset(tmp_path / "two", renamed, name="another")
    pairs = [replace(pair, index=pair.index + 7) for pair in second.pairs]
    moved = replace(second, pairs=pairs)
    assert keys(plan_of(context_of(first))) == keys(plan_of(context_of(moved)))


def test_a_seed_or_a_protocol_changes_every_key(views: Dataset) -> None:
    before = keys(plan_of(context_of(views)))
    for protocol in (MeasurementProtocol(seed=1), MeasurementProtocol(chance=None)):
        assert not before & keys(plan_of(context_of(views, protocol)))


def test_parameters_change_the_keys_of_what_uses_them(views: Dataset) -> None:
    plain = Preset("plain", "plain", True)
    context = replace(context_of(views), methods=METHODS.with_preset(plain))
    before = named_keys(plan_of(context))
    preset = replace(plain, detectors={"ORB": {"nfeatures": 9}})
    after = named_keys(plan_of(replace(context, methods=METHODS.with_preset(preset))))
    changed = {name for name in before if before[name] != after[name]}
    assert changed == {name for name in before if name[1].startswith("ORB-")}
    preset = Preset("odd", "odd", True, descriptors={"SIFT": {"sigma": 1.5}})
    after = named_keys(plan_of(replace(context, methods=METHODS.with_preset(preset))))
    changed = {name for name in before if before[name] != after[name]}
    assert changed == {name for name in before if "-SIFT-" in name[1]}


def test_the_content_of_an_image_changes_the_keys_of_its_pairs(tmp_path: Path) -> None:
    pictures = strip(4)
    before = named_keys(plan_of(context_of(write_dataset(tmp_path, pictures))))
    pictures["view_0.png"][5, 5] ^= 1
    after = named_keys(plan_of(context_of(write_dataset(tmp_path, pictures))))
    assert {name for name in before if before[name] != after[name]} == {
        name for name in before if name[0] == 0
    }


def test_the_truth_changes_the_key(tmp_path: Path) -> None:
    pictures = strip(2)
    shift = np.eye(3)
    one = write_dataset(tmp_path, pictures, homographies=[shift])
    other = write_dataset(tmp_path, pictures, homographies=[shift + 1e-9])
    none = write_dataset(tmp_path, pictures)
    found = [keys(plan_of(context_of(dataset))) for dataset in (one, other, none)]
    assert not found[0] & found[1]
    assert not found[0] & found[2]


def test_gray_images_rule_out_lucid_with_the_reason(tmp_path: Path) -> None:
    pictures = strip(4)
    pictures["view_3.png"] = pictures["view_3.png"][..., 0]
    plan = plan_of(context_of(write_dataset(tmp_path, pictures)))
    [exclusion] = plan.exclusions
    assert str(exclusion.combination) == "ORB-LUCID-HAM-BF"
    assert exclusion.pairs == 1
    assert "gray" in exclusion.reason
    assert plan.rows_planned == 3 * len(SOME) - 1
    assert (2, "ORB-LUCID-HAM-BF") not in named_keys(plan)
    assert (1, "ORB-LUCID-HAM-BF") in named_keys(plan)


def test_a_missing_file_is_an_error_that_names_it(tmp_path: Path) -> None:
    dataset = write_dataset(tmp_path, strip(2))
    (tmp_path / "view_1.png").unlink()
    with pytest.raises(ImageError, match=r"view_1\.png"):
        plan_of(context_of(dataset_of(tmp_path, [image.name for image in dataset.images])))


def test_progress_counts_every_image(views: Dataset) -> None:
    told: list[tuple[int, int]] = []
    make_plan(context_of(views), SOME, lambda key: False, lambda *step: told.append(step))
    assert told == [(1, 4), (2, 4), (3, 4), (4, 4)]


def test_descriptors_that_cost_far_more_than_detecting_are_units_of_their_own(
    views: Dataset,
) -> None:
    combinations = select(METHODS, "FAST-VGG-*,FAST-BOOST-HAM-BF,FAST-ORB-HAM-BF,FAST-BRIEF-*")
    plan = plan_of(context_of(views), combinations)
    together = [
        {combination.descriptor for work in unit.work for combination in work.combinations}
        for unit in plan.units
    ]
    assert together == [{"VGG"}, {"BOOST"}, {"ORB", "BRIEF"}]
    assert set(keys(plan).values()) == {1}
    # HL takes a sixth of what VGG takes on its keypoints: detecting twice would not pay.
    plan = plan_of(context_of(views), select(METHODS, "HL-VGG-L2-BF,HL-ORB-HAM-BF"))
    assert len(plan.units) == 1
