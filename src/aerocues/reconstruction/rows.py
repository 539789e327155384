"""Rows of the table of models: those that are finished, their identity, and writing them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict

from aerocues.errors import StoreError
from aerocues.methods.combination import Combination
from aerocues.reconstruction.agreement import outvoted
from aerocues.reconstruction.baseline import baseline_facts, baseline_row_key
from aerocues.reconstruction.engine import ReconstructionLimits
from aerocues.reconstruction.models import RETRIED, Models, has_files, read_outcome, write_table
from aerocues.reconstruction.references import with_distances
from aerocues.reconstruction.scene import Scene
from aerocues.results.metrics import Row
from aerocues.results.reconstruction_schema import BASELINE
from aerocues.results.store import Store

Rows = dict[Combination, Row]


def row_key(scene: Scene, combination: Combination) -> str:
    """Names a model and the files that are made of it."""
    return baseline_row_key(scene) if combination == BASELINE else scene.row_key(combination)


def finished_rows(
    scene: Scene,
    chosen: Iterable[Combination],
    limits: ReconstructionLimits,
    *,
    retry_failed: bool,
) -> Rows:
    """Rows of finished reconstructions that are still valid."""
    finished = {}
    for combination in chosen:
        place = scene.place(combination)
        row = read_outcome(place)
        if row is None or row.get("row_key") != row_key(scene, combination):
            continue
        if retry_failed and row["status"] in RETRIED:
            continue
        if row["status"] == "timeout" and row.get("time_limit", 0.0) < limits.seconds:
            continue  # it may end within the larger limit
        if row.get("registered_images") and not has_files(place):
            continue
        finished[combination] = row
    return finished


def other_rows(scene: Scene, chosen: Iterable[Combination]) -> Rows:
    """Rows of other models in the folder that were made under the same settings."""
    others = {}
    known = {BASELINE, *chosen}
    for place in sorted(scene.folder.glob("*-*-*-*/")):
        row = read_outcome(place)
        if row is None or row.get("settings_key") != scene.settings_key():
            continue
        combination = Combination.parse(place.name)
        if combination not in known:
            others[combination] = row
    return others


def identity_of(scene: Scene, combination: Combination) -> Row:
    """How the model of a row was made."""
    protocol = scene.protocol
    sources = ", ".join(sorted({group.source for group in scene.cameras}))
    refined = "refined" if protocol.refined else "fixed"
    facts: Row = {
        "dataset": scene.dataset.name,
        **asdict(combination),
        "images": len(scene.dataset.images),
        "pairs": len(scene.dataset.pairs),
        "preset": scene.preset,
        "pairing": dict(scene.dataset.settings).get("pairs", "own"),
        "max_keypoints": protocol.max_keypoints,
        "features_width": protocol.features_width,
        "intrinsics": f"{refined} ({sources})",
        "mapper": protocol.mapper,
        "seed": protocol.seed,
        "opencv_version": scene.versions[0],
        "colmap_version": scene.versions[1],
        "machine": scene.machine,
        "settings_key": scene.settings_key(),
        "row_key": row_key(scene, combination),
    }
    if combination == BASELINE:
        return {**facts, **baseline_facts(scene)}
    parameters = json.dumps(scene.parameters(combination), sort_keys=True)
    return {**facts, "parameters": parameters}


def write_rows(
    scene: Scene,
    rows: Mapping[Combination, Row],
    reference: Combination | None,
    store: Store | None,
) -> None:
    """Compare models with each other, and write the table here and to the results.

    COLMAP's default does not depend on the settings of the others; its row gets their key, so that
    they are stored together.
    """
    key = scene.settings_key()
    same = {combination: {**row, "settings_key": key} for combination, row in rows.items()}
    cloud_of = Models(scene.folder).cloud
    judged = outvoted(same, cloud_of, scene.protocol.requirements)
    measured, clouds = with_distances(judged, cloud_of, reference)
    table = write_table(scene.folder, measured)
    if store is None:
        return
    try:
        with store.writing():
            for name, cloud in clouds.items():
                store.write_cloud(name, cloud)
            store.add_reconstructions(table)
    except StoreError as error:
        raise StoreError(f"the models are finished, but {error}") from error
