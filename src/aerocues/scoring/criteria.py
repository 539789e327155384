"""The criteria of alternatives: one row each."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Literal

from aerocues.errors import ScoreError
from aerocues.scoring.links import ENOUGH

Better = Literal["higher", "lower"]
DIRECTIONS: tuple[Better, ...] = ("higher", "lower")
Aspect = Literal["accuracy", "quantity", "speed", "other"]


@dataclass(frozen=True)
class Criterion:
    """One criterion.

    Attributes
    ----------
    name : str
    better : {"higher", "lower"}
        Benefit or cost.
    column : str
        A column of the measurements, or a SQL expression of columns; by default the name.
    reconstruction : bool
        Whether it has one value per alternative (from a 3D model) in place of one per pair.
    description : str
    beyond_chance : bool
        Whether it needs the test against chance, which also verifies shuffled matches.
    aspect : {"accuracy", "quantity", "speed", "other"}
        What it tells of: objectives weigh these.
    reference : bool
        Whether only pairs with a reference have it.

    Raises
    ------
    ScoreError
        If it has no name, or an unknown direction.
    """

    name: str
    better: Better = "higher"
    column: str = ""
    reconstruction: bool = False
    description: str = ""
    beyond_chance: bool = False
    aspect: Aspect = "other"
    reference: bool = False

    def __post_init__(self) -> None:
        if not self.name:
            raise ScoreError("a criterion needs a name")
        if self.better not in DIRECTIONS:
            raise ScoreError(
                f"criterion {self.name}: better must be 'higher' or 'lower', got {self.better!r}"
            )

    @property
    def source(self) -> str:
        """The column or expression that gives its values."""
        return self.column or self.name


def _beyond_chance(divisor: str) -> str:
    return f"excess_inliers / nullif({divisor}, 0)"


_BY_PAIRS: tuple[Criterion, ...] = (
    Criterion("recall", description="inliers / keypoints of image 1", aspect="accuracy"),
    Criterion("precision", description="inliers / matches: the inlier ratio", aspect="accuracy"),
    Criterion(
        "repeatability", description="inliers / the smaller number of keypoints", aspect="accuracy"
    ),
    Criterion("f1_score", description="harmonic mean of precision and recall", aspect="accuracy"),
    Criterion("inliers", description="matches that agree with the model", aspect="quantity"),
    Criterion("matches", description="mutual matches", aspect="quantity"),
    Criterion(
        "seconds_per_1k_matches", "lower", description="seconds for 1000 matches", aspect="speed"
    ),
    Criterion(
        "seconds_per_1k_inliers", "lower", description="seconds for 1000 inliers", aspect="speed"
    ),
    Criterion(
        "recall_beyond_chance",
        column=_beyond_chance("keypoints_1"),
        description="excess inliers / keypoints of image 1",
        beyond_chance=True,
        aspect="accuracy",
    ),
    Criterion(
        "precision_beyond_chance",
        description="excess inliers / matches",
        beyond_chance=True,
        aspect="accuracy",
    ),
    Criterion(
        "repeatability_beyond_chance",
        column=_beyond_chance("least(keypoints_1, keypoints_2)"),
        description="excess inliers / the smaller number of keypoints",
        beyond_chance=True,
        aspect="accuracy",
    ),
    Criterion(
        "f1_beyond_chance",
        # The harmonic mean of excess / matches and excess / keypoints_1.
        column="2 * excess_inliers / nullif(matches + keypoints_1, 0)",
        description="harmonic mean of precision and recall beyond chance",
        beyond_chance=True,
        aspect="accuracy",
    ),
    Criterion(
        "excess_inliers",
        description="inliers minus the inliers of shuffled matches",
        beyond_chance=True,
        aspect="quantity",
    ),
    Criterion(
        "seconds_per_1k_excess_inliers",
        "lower",
        column="1000 * total_seconds / nullif(excess_inliers, 0)",
        description="seconds for 1000 inliers beyond chance",
        beyond_chance=True,
        aspect="speed",
    ),
    Criterion(
        "total_seconds", "lower", description="seconds for one image and one pair", aspect="speed"
    ),
    Criterion(
        "seconds_per_1k_keypoints",
        "lower",
        description="seconds for 1000 keypoints",
        aspect="speed",
    ),
    Criterion("descriptor_bytes", "lower", description="bytes of one descriptor"),
    Criterion("peak_memory_mb", "lower", description="largest increase of memory in one stage"),
)

RIGHT_MATCHES, EXACT_MATCHES = "ref_matches@3", "ref_matches@1"
EXPECTED_QUALITY = "expected_quality"
LINKS = "links"
_REFERENCE: tuple[Criterion, ...] = (
    Criterion(
        "ref_matching_score@3",
        description="matches right within 3 px of the reference / keypoints of image 1",
        aspect="accuracy",
        reference=True,
    ),
    Criterion(
        "ref_precision@3",
        description="share of matches right within 3 px of the reference",
        aspect="accuracy",
        reference=True,
    ),
    Criterion(
        "ref_repeatability",
        description="covisible keypoints found again within 3 px, by the reference",
        aspect="accuracy",
        reference=True,
    ),
    Criterion(
        RIGHT_MATCHES,
        description="matches right within 3 px of the reference",
        aspect="quantity",
        reference=True,
    ),
    Criterion(
        "coverage",
        description="share of the cells of a 16 x 16 grid on image 1 that hold a right match",
        aspect="quantity",
        reference=True,
    ),
    Criterion(
        "sharpness",
        column=f'"{EXACT_MATCHES}" / nullif("{RIGHT_MATCHES}", 0)',
        description="matches right within 1 px / within 3 px of the reference",
        aspect="accuracy",
        reference=True,
    ),
    Criterion(
        EXPECTED_QUALITY,
        # A pair without right matches is a failed one only where its row says so.
        column=f'case when "{RIGHT_MATCHES}" > 0 then "{EXACT_MATCHES}" / sqrt("{RIGHT_MATCHES}")'
        f' when "{RIGHT_MATCHES}" = 0 then 0.0 end',
        description="of a model, by a pair: sqrt(matches right within 3 px) x share of these that "
        "are right within 1 px",
        aspect="quantity",
        reference=True,
    ),
    Criterion(
        LINKS,
        # Not `least`, which leaves null out: a failed pair would be a sure link.
        column=f'(case when "{RIGHT_MATCHES}" > {ENOUGH} then {ENOUGH} else "{RIGHT_MATCHES}" end)'
        f" / {ENOUGH}",
        description=f"how surely a pair is linked: right matches / {ENOUGH:.0f}, at most 1",
        reference=True,
    ),
    Criterion(
        "seconds_per_1k_ref_matches",
        "lower",
        description="seconds for 1000 matches right within 3 px of the reference",
        aspect="speed",
        reference=True,
    ),
)

_GROUND_TRUTH: tuple[Criterion, ...] = (
    *(
        Criterion(f"gt_precision@{t}", description=f"share of matches correct within {t} px")
        for t in (1, 3, 5)
    ),
    *(
        Criterion(
            f"gt_matching_score@{t}", description=f"matches correct within {t} px / keypoints"
        )
        for t in (1, 3, 5)
    ),
    Criterion("gt_repeatability", description="covisible keypoints found again within 3 px"),
    *(
        Criterion(f"homography_auc@{t}", description=f"accuracy of the homography up to {t} px")
        for t in (1, 3, 5)
    ),
    *(
        Criterion(f"pose_auc@{a}", description=f"accuracy of the relative pose up to {a} degrees")
        for a in (5, 10, 20)
    ),
)

_RECONSTRUCTION: tuple[Criterion, ...] = (
    Criterion(
        "reprojection_error",
        "lower",
        reconstruction=True,
        description="mean reprojection error of the 3D points in pixels",
    ),
    Criterion("points_3d", reconstruction=True, description="3D points of the model"),
    Criterion(
        "reconstruction_seconds",
        "lower",
        reconstruction=True,
        description="seconds of the reconstruction",
    ),
    Criterion(
        "registered_share",
        column="registered_images / images",
        reconstruction=True,
        description="images in the model / images of the scene",
    ),
    Criterion(
        "mean_track_length",
        reconstruction=True,
        description="mean number of images per 3D point",
    ),
    Criterion(
        "position_error_share",
        "lower",
        reconstruction=True,
        description="error of the camera positions / extent of the true positions",
    ),
)

CRITERIA: tuple[Criterion, ...] = (*_BY_PAIRS, *_REFERENCE, *_GROUND_TRUTH, *_RECONSTRUCTION)
RECONSTRUCTION = tuple(criterion.name for criterion in _RECONSTRUCTION)


def criteria_named(names: Iterable[str], known: Sequence[Criterion] = CRITERIA) -> list[Criterion]:
    """The criteria of these names, in that order.

    Raises
    ------
    ScoreError
        If none is named, one is named twice, or one does not exist.
    """
    by_name = {criterion.name: criterion for criterion in known}
    chosen = [name.strip() for name in names]
    if not chosen:
        raise ScoreError("name at least one criterion")
    for name in chosen:
        if name not in by_name:
            near = get_close_matches(name, by_name, n=3, cutoff=0.4) or list(by_name)[:3]
            raise ScoreError(
                f"there is no criterion {name!r}; did you mean {' or '.join(near)}? "
                "docs/scoring.md lists all"
            )
        if chosen.count(name) > 1:
            raise ScoreError(f"criterion {name} is named twice; name it once")
    return [by_name[name] for name in chosen]
