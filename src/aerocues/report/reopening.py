"""Opens the images of results again, as they were measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.dataset import Dataset, Pair, with_turns
from aerocues.errors import DatasetError
from aerocues.evaluation.unit import Context
from aerocues.methods.plugins import installed_methods
from aerocues.methods.preset_files import recorded_preset
from aerocues.methods.strongest import KeypointLimit
from aerocues.pipeline.protocol import ChanceTest, MeasurementProtocol, Verification
from aerocues.report.entry import ReportEntry
from aerocues.results.store import REFERENCES

HINT = "name the place where they are now as `images`, such as oxford:DIR"


def context_of(found: ReportEntry, moved: Sequence[str] = ()) -> Context:
    """The context to repeat measurements of an entry.

    Parameters
    ----------
    found : ReportEntry
    moved : sequence of str
        Datasets in the form of `open_dataset`. The first one with all images of the entry replaces
        the dataset that the results name.

    Raises
    ------
    DatasetError
        If the location of the images is unknown, or images are missing.
    SelectionError
        If the preset of the results is unknown here.
    """
    settings = found.settings
    measured = settings.get("dataset") or {}
    if settings.get("imported") or measured.get("name") != found.entry.dataset:
        raise DatasetError("the measurements were imported and their images are unknown")
    preset = recorded_preset(settings)
    try:
        protocol = _protocol(settings["protocol"])
    except (KeyError, TypeError) as error:
        raise DatasetError(f"run.json does not say how they were measured ({error})") from error
    references = found.results.folder / REFERENCES
    return Context(
        dataset=_with_pairs(
            with_turns(_dataset(found, measured, moved), measured.get("turned", {})), found.pairs()
        ),
        methods=protocol.limit.limited(installed_methods().with_preset(preset)),
        preset=preset.name,
        protocol=protocol,
        settings_key=str(settings["settings_key"]),
        machine=found.entry.machine,
        references=references.absolute() if references.is_dir() else None,
    )


def _dataset(found: ReportEntry, measured: Mapping[str, Any], moved: Sequence[str]) -> Dataset:
    settings = measured.get("settings", {})
    width = settings.get("max_width", "full")
    options: dict[str, Any] = {
        "max_width": int(width) if str(width).isdecimal() else None,
        "equalize": settings.get("equalize", "none"),
    }
    if (band := measured["settings"].get("band")) is not None:
        options["band"] = int(band)
    if (every := measured["settings"].get("every")) is not None:
        options["every"] = float(every)
    for spec in moved:
        dataset = open_dataset(spec, **options)
        if not _missing(dataset, found):
            return dataset
    source = measured.get("source")
    if not source or "spec" not in source:
        raise DatasetError(f"the results do not say where the images are; {HINT}")
    dataset = open_dataset(str(source["spec"]), **options)
    if missing := _missing(dataset, found):
        raise DatasetError(f"the image {missing} is missing; {HINT}")
    return dataset


def _missing(dataset: Dataset, found: ReportEntry) -> str | None:
    """An image of the entry that is not in the dataset."""
    names = {image.name for image in dataset.images}
    needed = (pair[image] for pair in found.pairs() for image in ("image_1", "image_2"))
    return next((name for name in needed if name not in names), None)


def _with_pairs(dataset: Dataset, pairs: Sequence[Mapping[str, Any]]) -> Dataset:
    """The dataset with exactly the measured pairs."""
    known = {(pair.image_1, pair.image_2): pair.homography for pair in dataset.pairs}
    made = []
    for pair in pairs:
        names = pair["image_1"], pair["image_2"]
        made.append(Pair(pair["pair"], *names, pair["sequence"], known.get(names)))
    return replace(dataset, pairs=made)


def _protocol(recorded: Mapping[str, Any]) -> MeasurementProtocol:
    chance = recorded["chance"]
    return MeasurementProtocol(
        seed=recorded["seed"],
        timing=recorded["timing"],
        verification=Verification(**recorded["verification"]),
        chance=ChanceTest(**chance) if chance else None,
        limit=KeypointLimit(**recorded.get("limit", {})),
        thresholds=recorded.get("thresholds", {}),
    )
