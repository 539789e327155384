"""COLMAP's mappers, with the same settings for all combinations."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

from aerocues.reconstruction.colmap import registered, require
from aerocues.reconstruction.protocol import ReconstructionProtocol


def map_scene(
    database: Path,
    images: Path,
    folder: Path,
    protocol: ReconstructionProtocol,
    largest_error: float | None = None,
) -> list[Any]:
    """All models of the mapper, sorted by number of images, then points, the largest first.

    Parameters
    ----------
    database, images : path
    folder : path
        Temporary folder for the output of the mapper; it is removed again.
    protocol : ReconstructionProtocol
    largest_error : float, optional
        Pixels from its keypoint at which a point may be projected; COLMAP's own by default.

    Raises
    ------
    ReconstructionError
        If this version of pycolmap lacks the mapper.
    """
    import pycolmap

    if protocol.mapper == "global":
        mapper = require("global_mapping", '`mapper="global"`')
        options = _global_options(protocol)
    else:
        mapper = pycolmap.incremental_mapping
        options = _incremental_options(protocol, largest_error)
    return _mapped(mapper, (database, images, folder), options, protocol.seed)


def map_by_default(database: Path, images: Path, folder: Path, seed: int) -> list[Any]:
    """The same with COLMAP's own settings: its camera is refined, and it adjusts more often."""
    import pycolmap

    options = _repeatable_options(seed)
    return _mapped(pycolmap.incremental_mapping, (database, images, folder), options, seed)


def _mapped(mapper: Any, paths: tuple[Path, Path, Path], options: Any, seed: int) -> list[Any]:
    import pycolmap

    database, images, folder = paths
    pycolmap.set_random_seed(seed)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    try:
        models = mapper(database, images, folder, options)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return sorted(
        models.values(), key=lambda model: (-len(registered(model)), -len(model.points3D))
    )


def _repeatable_options(seed: int) -> Any:
    """COLMAP's settings of the incremental mapper, with one thread and a seed."""
    import pycolmap

    options = pycolmap.IncrementalPipelineOptions()
    options.num_threads = 1
    options.extract_colors = False
    for part in (options, options.mapper, options.triangulation):
        if hasattr(part, "random_seed"):
            part.random_seed = seed
    return options


def _incremental_options(protocol: ReconstructionProtocol, largest_error: float | None) -> Any:
    refine, settings = protocol.refined, protocol.mapping
    options = _repeatable_options(protocol.seed)
    options.multiple_models = True
    options.min_model_size = settings.smallest_model
    options.max_num_models = settings.most_models
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
    if largest_error is not None:
        options.mapper.filter_max_reproj_error = largest_error
        options.triangulation.complete_max_reproj_error = largest_error
        options.triangulation.merge_max_reproj_error = largest_error
    return options


def _global_options(protocol: ReconstructionProtocol) -> Any:
    import pycolmap

    refine = protocol.refined
    options = pycolmap.GlobalPipelineOptions()
    options.num_threads = 1
    options.random_seed = protocol.seed
    options.multiple_models = True
    options.min_model_size = protocol.mapping.smallest_model
    adjustment = options.mapper.bundle_adjustment
    adjustment.refine_focal_length = refine
    adjustment.refine_extra_params = refine
    return options
