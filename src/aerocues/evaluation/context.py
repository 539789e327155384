"""The context that all units of a measurement share, and its record in ``run.json``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

from aerocues.datasets.dataset import Dataset, turns_of
from aerocues.errors import MethodUnavailableError
from aerocues.evaluation.plan import Plan
from aerocues.evaluation.unit import Context
from aerocues.methods.combination import Combination
from aerocues.methods.exact.availability import why_not_exact
from aerocues.methods.plugins import installed_methods
from aerocues.methods.presets import Preset
from aerocues.methods.strongest import ALL_KEYPOINTS, KeypointLimit
from aerocues.pipeline.protocol import MeasurementProtocol
from aerocues.results.hashing import content_hash
from aerocues.results.timing import Timing
from aerocues.results.versions import machine_facts, machine_name, software_versions


def make_context(
    dataset: Dataset,
    preset: Preset,
    *,
    seed: int = 0,
    timing: Timing = "shared",
    limit: KeypointLimit = ALL_KEYPOINTS,
) -> Context:
    """The context that all units of a measurement share; parameters as in `run.run`.

    Raises
    ------
    MethodUnavailableError
        If times are to be estimated, but exact matching is unavailable.
    """
    problem = why_not_exact() if timing == "estimated" else None
    if problem:
        raise MethodUnavailableError(f"times cannot be estimated here: {problem}")
    protocol = MeasurementProtocol.of_preset(preset, seed=seed, timing=timing, limit=limit)
    versions = software_versions()
    settings_key = content_hash([preset.name, protocol.identity(), versions["opencv"]])
    return Context(
        dataset=dataset,
        methods=limit.limited(installed_methods().with_preset(preset)),
        preset=preset.name,
        protocol=protocol,
        settings_key=settings_key,
        machine=machine_name(),
    )


def run_facts(
    context: Context, preset: Preset, plan: Plan, combinations: Sequence[Combination]
) -> dict[str, object]:
    """Configuration, versions and machine of a run, as ``run.json`` records them."""
    return {
        "settings_key": context.settings_key,
        "dataset": {
            "name": context.dataset.name,
            "geometry": context.dataset.geometry,
            "images": len(context.dataset.images),
            "pairs": len(context.dataset.pairs),
            "settings": dict(context.dataset.settings),
            "turned": turns_of(context.dataset),
            "source": asdict(context.dataset.source) if context.dataset.source else None,
        },
        "preset": context.preset,
        "preset_parts": asdict(preset),
        "protocol": asdict(context.protocol),
        "features": str(context.features) if context.features else None,
        "combinations": [str(combination) for combination in combinations],
        "exclusions": [
            {"combination": str(e.combination), "reason": e.reason, "pairs": e.pairs}
            for e in plan.exclusions
        ],
        "versions": software_versions(),
        "machine": machine_facts(),
    }
