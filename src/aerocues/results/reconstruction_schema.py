"""The table of 3D reconstructions: one row a dataset and combination."""

from __future__ import annotations

from aerocues.results.combination_columns import METHODS
from aerocues.results.schema import IDENTITY, Column
from aerocues.results.statuses import Status

RECONSTRUCTION_IDENTITY = ("dataset", *METHODS)

RECONSTRUCTION_STATUSES: tuple[Status, ...] = (
    Status("ok", "one model holds the images, and its cameras are where they were"),
    Status("no_features", "no image, or one only, has keypoints with a descriptor"),
    Status("no_verified_pair", "no pair of images has a geometry that beats chance"),
    Status("no_initial_pair", "no pair suits to begin a model with: too few inliers, or too flat"),
    Status("no_model", "models were begun, and none held"),
    Status("incomplete", "the largest model holds too few of the images"),
    Status("misplaced", "too few cameras of the model are where they were"),
    Status("error", "a method or the mapper raised an error; the message has it", retried=True),
    Status("crashed", "the process died; the message says in which stage", retried=True),
    Status("timeout", "a stage used up its time limit", retried=True),
    Status("out_of_memory", "a stage asked for more memory than the limit", retried=True),
)


def _text(name: str, definition: str) -> Column:
    return Column(name, "string", "", definition)


def _count(name: str, definition: str) -> Column:
    return Column(name, "integer", "count", definition)


def _number(name: str, unit: str, definition: str) -> Column:
    return Column(name, "float", unit, definition)


_OUTCOME = (
    _text("status", "how the reconstruction ended"),
    _text("message", "why it failed, or what is unusual"),
)
_MODEL = (
    _count("images", "images that were to be reconstructed"),
    _count("registered_images", "images of the largest model, the only one that is judged"),
    _count("components", "models that the mapper made; more than one: the scene fell apart"),
    _count("points_3d", "3D points of the model; none is begun with two images only"),
    _count("observations", "keypoints that see a 3D point"),
    _number("mean_track_length", "images", "observations / points_3d"),
    _number(
        "reprojection_error",
        "px",
        "mean over 3D points of the mean distance between keypoint and projection (as COLMAP)",
    ),
    _number("observation_error", "px", "mean of that distance over all observations"),
    _number("focal_length", "px", "focal length of the model's first camera"),
)
_MATCHES = (
    _count("pairs", "pairs of images that were matched"),
    _count("linked_pairs", "pairs whose matches beat chance"),
    _count("verified_pairs", "linked pairs that COLMAP verified"),
    _count("matches", "matches of all pairs"),
    _count("verified_matches", "matches that agree with the geometry of a verified pair"),
)
_TIMES = (
    _number("feature_seconds", "s", "CPU seconds to detect and describe in all images"),
    _number("matching_seconds", "s", "CPU seconds to match all pairs"),
    _number("verification_seconds", "s", "CPU seconds of the chance test and the verification"),
    _number("mapping_seconds", "s", "CPU seconds of the mapper"),
    _number("reconstruction_seconds", "s", "sum of the four: from images to a model"),
)
_TRUTH = (
    _number("position_rmse", "m", "root mean square distance of camera centres from the truth"),
    _number("position_median", "m", "median of that distance"),
    _number("position_error_share", "ratio", "position_rmse / extent of the true positions"),
    _count("placed_images", "registered images whose cameras are in their place"),
    _text("truth", "what positions are compared with: gps or poses"),
    _number("rotation_error", "degree", "median rotation from the true orientation (poses)"),
    _number("surface_error", "m", "median distance of 3D points from the true surface (depth)"),
)
_CLOUD_DISTANCES = (
    _text("reference", "combination whose cloud the distances are to"),
    *(
        _number(f"cloud_distance_{statistic}", "m", f"{text} distance of a point to the reference")
        for statistic, text in (
            ("median", "median"),
            ("rms", "root mean square"),
            ("p95", "95th percentile of the"),
        )
    ),
    *(
        _number(f"reference_distance_{statistic}", "m", f"{text} distance of a reference point")
        for statistic, text in (
            ("median", "median"),
            ("rms", "root mean square"),
            ("p95", "95th percentile of the"),
        )
    ),
    _text("length_unit", "of these distances: m, or the unit of the reference's model"),
)
_PROVENANCE = (
    _text("preset", "preset of parameters of the methods"),
    _text("parameters", "parameters of detector, descriptor and matcher, as JSON"),
    _text("pairing", "how pairs were chosen"),
    _count("max_keypoints", "strongest keypoints kept in an image; 0: all"),
    _text("intrinsics", "fixed or refined, and where the focal length is from"),
    _text("mapper", "incremental or global"),
    Column("seed", "integer", "", "seed of every stage"),
    _text("opencv_version", "version of OpenCV"),
    _text("colmap_version", "version of pycolmap"),
    _text("machine", "processor that reconstructed"),
    _number("reconstructed_at", "s", "when, in seconds since 1970 (UTC)"),
    _text("settings_key", "hash of what all combinations of a dataset have in common"),
    _text("row_key", "hash of everything that decides the model; names its cloud"),
)

RECONSTRUCTIONS: tuple[Column, ...] = (
    *(column for column in IDENTITY if column.name in RECONSTRUCTION_IDENTITY),
    *_OUTCOME,
    *_MODEL,
    *_MATCHES,
    *_TIMES,
    *_TRUTH,
    *_CLOUD_DISTANCES,
    *_PROVENANCE,
)
