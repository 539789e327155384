"""COLMAP's mappers, with the same settings for all combinations."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

from aerocues.reconstruction.colmap import registered, require
from aerocues.reconstruction.protocol import ReconstructionProtocol


def map_scene(
    database: Path, images: Path, folder: Path, protocol: ReconstructionProtocol
) -> list[Any]:
    """All models of the mapper, sorted by number of images, then points, the largest first.

    Parameters
    ----------
    database, images : path
    folder : path
        Temporary folder for the output of the mapper; it is removed again.
    protocol : ReconstructionProtocol

    Raises
    ------
    ReconstructionError
        If this version of pycolmap lacks the mapper.
    """
    import pycolmap

    pycolmap.set_random_seed(protocol.seed)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    try:
        if protocol.mapper == "global":
            mapper = require("global_mapping", '`mapper="global"`')
            models = mapper(database, images, folder, _global_options(protocol))
        else:
            models = pycolmap.incremental_mapping(
                database, images, folder, _incremental_options(protocol)
            )
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return sorted(
        models.values(), key=lambda model: (-len(registered(model)), -len(model.points3D))
    )


def _incremental_options(protocol: ReconstructionProtocol) -> Any:
    import pycolmap

    refine, settings = protocol.intrinsics == "refine", protocol.mapping
    options = pycolmap.IncrementalPipelineOptions()
    options.num_threads = 1
    options.multiple_models = True
    options.min_model_size = settings.smallest_model
    options.max_num_models = settings.most_models
    options.extract_colors = False
    options.ba_refine_focal_length = refine
    options.ba_refine_extra_params = refine
    options.ba_refine_principal_point = False
    options.mapper.abs_pose_refine_focal_length = refine
    options.mapper.abs_pose_refine_extra_params = refine
    # Newer versions name these options after frames, older ones after images.
    ratio = settings.global_adjustment_ratio
    for name in ("ba_global_frames_ratio", "ba_global_images_ratio", "ba_global_points_ratio"):
        if hasattr(options, name):
            setattr(options, name, ratio)
    options.ba_global_max_refinements = settings.global_refinements
    options.ba_local_max_refinements = settings.local_refinements
    for part in (options, options.mapper, options.triangulation):
        if hasattr(part, "random_seed"):
            part.random_seed = protocol.seed
    return options


def _global_options(protocol: ReconstructionProtocol) -> Any:
    import pycolmap

    refine = protocol.intrinsics == "refine"
    options = pycolmap.GlobalPipelineOptions()
    options.num_threads = 1
    options.random_seed = protocol.seed
    options.multiple_models = True
    options.min_model_size = protocol.mapping.smallest_model
    adjustment = options.mapper.bundle_adjustment
    adjustment.refine_focal_length = refine
    adjustment.refine_extra_params = refine
    return options
