"""The table of 3D reconstructions: one row per dataset and combination."""

from __future__ import annotations

from aerocues.methods.combination import Combination
from aerocues.results.combination_columns import METHODS
from aerocues.results.schema import IDENTITY, Column
from aerocues.results.statuses import Status

# COLMAP by its own defaults, a row beside the combinations, to compare them with: its SIFT, its
# matcher and a camera that it refines.
BASELINE = Combination("COLMAP", "SIFT", "L2", "COLMAP")
RECONSTRUCTION_IDENTITY = ("dataset", *METHODS)

RECONSTRUCTION_STATUSES: tuple[Status, ...] = (
    Status("ok", "the model has enough images, and its cameras are close to their true positions"),
    Status("no_features", "at most one image has keypoints with descriptors"),
    Status("no_verified_pair", "no pair of images has a geometry that beats chance"),
    Status(
        "no_initial_pair",
        "no pair is suitable to start a model: too few inliers, or too little parallax",
    ),
    Status("no_model", "the mapper started models, but none was completed"),
    Status("incomplete", "the largest model has too few of the images"),
    Status("misplaced", "too few cameras of the model are close to their true positions"),
    Status("error", "a method or the mapper raised an error; see the message", retried=True),
    Status("crashed", "the process died; the message names the stage", retried=True),
    Status("timeout", "a stage exceeded its time limit", retried=True),
    Status("out_of_memory", "a stage exceeded the memory limit", retried=True),
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
    _count("images", "images to be reconstructed"),
    _count(
        "registered_images", "images of the largest model, which is the only one that is evaluated"
    ),
    _count(
        "components", "models that the mapper made; more than 1 means that the scene fell apart"
    ),
    _count("points_3d", "3D points of the model; points seen by only two images are not created"),
    _count("points_in_3_images", "3D points that are observed in 3 images or more"),
    _count("observations", "keypoints that observe a 3D point"),
    _number("mean_track_length", "images", "observations / points_3d"),
    _number(
        "reprojection_error",
        "px",
        "mean over 3D points of the mean distance between keypoint and projection (as in COLMAP)",
    ),
    _number(
        "model_quality",
        "",
        "placed_images / images x sqrt(points_in_3_images / error): surface_error or position_rmse "
        "where poses are known, else reprojection_error",
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
_REFINEMENT = (
    _number(
        "refinable_share",
        "ratio",
        "observations of tracks that look like their reference within 4 px of their keypoint; "
        "nearly the true share of matches, without ground truth",
    ),
    _number("refined_share", "ratio", "the same after a second look where neighbours point to"),
    _number("refinement_shift", "px", "median distance by which refined keypoints were moved"),
    _number(
        "refinement_gain",
        "ratio",
        "median distance from where neighbours say a keypoint lies, before / after",
    ),
    _number("keypoint_error", "px", "error of a keypoint's coordinate, from verified matches"),
    _number("error_limit", "px", "how far the mapper lets a point be from its keypoint"),
)
_TIMES = (
    _number("feature_seconds", "s", "CPU seconds to detect and describe in all images"),
    _number("matching_seconds", "s", "CPU seconds to match all pairs"),
    _number("verification_seconds", "s", "CPU seconds of the chance test and the verification"),
    _number("refinement_seconds", "s", "CPU seconds to refine keypoints"),
    _number("mapping_seconds", "s", "CPU seconds of the mapper"),
    _number("reconstruction_seconds", "s", "sum of these: from images to a model"),
)
_TRUTH = (
    _number(
        "position_rmse",
        "m",
        "root mean square distance of camera centres from their true positions",
    ),
    _number("position_median", "m", "median of that distance"),
    _number("position_error_share", "ratio", "position_rmse / extent of the true positions"),
    _number("plan_rmse", "m", "root mean square horizontal distance of camera centres"),
    _number("height_rmse", "m", "root mean square vertical distance of camera centres"),
    _count("placed_images", "registered images whose cameras are close to their true positions"),
    _text(
        "truth",
        "source of the true positions: poses, gps, gps in plan (its heights are wrong), or models "
        "(that agree with each other and not with GPS)",
    ),
    _number("rotation_error", "degree", "median rotation from the true orientation (poses)"),
    _number("surface_error", "m", "median distance of 3D points from the true surface (depth)"),
)
_CLOUD_DISTANCES = (
    _text("reference", "combination whose cloud is the reference of the distances"),
    *(
        _number(f"cloud_distance_{statistic}", "m", f"{text} distance of a point to the reference")
        for statistic, text in (
            ("median", "median"),
            ("rms", "root mean square"),
            ("p95", "95th percentile of the"),
        )
    ),
    *(
        _number(
            f"reference_distance_{statistic}",
            "m",
            f"{text} distance of a reference point to the model",
        )
        for statistic, text in (
            ("median", "median"),
            ("rms", "root mean square"),
            ("p95", "95th percentile of the"),
        )
    ),
    _text("length_unit", "unit of these distances: m, or the unit of the reference model"),
)
_PROVENANCE = (
    _text("preset", "preset of parameters of the methods"),
    _text("parameters", "parameters of detector, descriptor and matcher, as JSON"),
    _text("pairing", "how pairs were chosen"),
    _count("max_keypoints", "maximum number of keypoints per image, the strongest; 0: all"),
    _count("features_width", "width of the images that features were found in, if smaller"),
    _text("intrinsics", "fixed or refined, and the source of the focal length"),
    _text("mapper", "incremental or global"),
    Column("seed", "integer", "", "seed of every stage"),
    _text("opencv_version", "version of OpenCV"),
    _text("colmap_version", "version of pycolmap"),
    _text("machine", "processor of the machine"),
    _number("reconstructed_at", "s", "time of the reconstruction, in seconds since 1970 (UTC)"),
    _text("settings_key", "hash of the settings that all combinations of a dataset share"),
    _text("row_key", "hash of everything that the model depends on; the name of its cloud"),
)

RECONSTRUCTIONS: tuple[Column, ...] = (
    *(column for column in IDENTITY if column.name in RECONSTRUCTION_IDENTITY),
    *_OUTCOME,
    *_MODEL,
    *_MATCHES,
    *_REFINEMENT,
    *_TIMES,
    *_TRUTH,
    *_CLOUD_DISTANCES,
    *_PROVENANCE,
)
