"""The parameter grid of each method: one row per detector or descriptor.

Every combination of the values of all parameters is tried, and the default. Values come from the
papers, from OpenCV's documentation and from the defaults of similar methods.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import Literal

from aerocues.errors import SelectionError
from aerocues.json_files import read_json
from aerocues.methods.parameters import Value

Kind = Literal["detector", "descriptor"]
Setting = Mapping[str, Value]
SCALES = (0.75, 1.0, 2.5, 5.0, 6.25, 8.0)
"""Patch of a descriptor over the keypoint size, which each detector defines differently."""
THRESHOLDS = (1.0, 1.5, 2.0, 3.0, 4.0)
"""Inlier thresholds in pixels; tried where ground truth can validate them."""


@dataclass(frozen=True)
class Grid:
    """The grid of one method.

    Parameters
    ----------
    kind : {"detector", "descriptor"}
    method : str
    values : mapping of parameter to values
    partner : str
        The descriptor (for a detector) or detector (for a descriptor) that it is evaluated with.
    on_each_detector : mapping of parameter to values
        For a descriptor: a grid that is searched separately for each detector.
    """

    kind: Kind
    method: str
    values: Mapping[str, tuple[Value, ...]]
    partner: str
    on_each_detector: Mapping[str, tuple[Value, ...]] = field(default_factory=dict)


def settings_of(values: Mapping[str, tuple[Value, ...]], default: Setting) -> list[Setting]:
    """All settings of a grid: the default (empty) first, then those that differ from it.

    A setting contains only the values that differ from the default.
    """
    found: list[Setting] = [{}]
    for chosen in product(*values.values()):
        setting = {
            name: value
            for name, value in zip(values, chosen, strict=True)
            if default.get(name) != value
        }
        if setting and setting not in found:
            found.append(setting)
    return found


def _detector(method: str, partner: str, **values: tuple[Value, ...]) -> Grid:
    return Grid("detector", method, values, partner)


def _descriptor(method: str, partner: str, **values: tuple[Value, ...]) -> Grid:
    return Grid("descriptor", method, values, partner)


_FAST, _AGAST = "FastFeatureDetector", "AgastFeatureDetector"
GRIDS: tuple[Grid, ...] = (
    _detector(
        "SIFT",
        "SIFT",
        contrastThreshold=(0.005, 0.01, 0.02, 0.03, 0.04),
        edgeThreshold=(10.0, 15.0, 20.0),
    ),
    _detector(
        "AKAZE",
        "AKAZE",
        threshold=(0.0002, 0.0005, 0.001, 0.002),
        diffusivity=("KAZE.DIFF_PM_G1", "KAZE.DIFF_PM_G2", "KAZE.DIFF_WEICKERT"),
    ),
    _detector("ORB", "ORB", scaleFactor=(1.1, 1.2, 1.3), nlevels=(6, 8), fastThreshold=(10, 20)),
    _detector("BRISK", "BRISK", thresh=(15, 30, 45), octaves=(2, 3, 4)),
    _detector(
        "KAZE",
        "KAZE",
        threshold=(0.0005, 0.001, 0.003),
        diffusivity=("KAZE.DIFF_CHARBONNIER", "KAZE.DIFF_PM_G2", "KAZE.DIFF_WEICKERT"),
    ),
    _detector(
        "FAST",
        "SIFT",
        threshold=(5, 10, 20),
        type=(f"{_FAST}.TYPE_5_8", f"{_FAST}.TYPE_7_12", f"{_FAST}.TYPE_9_16"),
    ),
    _detector("MSER", "SIFT", delta=(3, 5, 8), max_variation=(0.15, 0.25, 0.5), min_area=(20, 60)),
    _detector(
        "AGAST",
        "SIFT",
        threshold=(10, 20, 30),
        type=(f"{_AGAST}.AGAST_5_8", f"{_AGAST}.AGAST_7_12d", f"{_AGAST}.OAST_9_16"),
    ),
    _detector(
        "GFTT", "SIFT", qualityLevel=(0.003, 0.01, 0.03), minDistance=(1.0, 3.0), blockSize=(3, 5)
    ),
    _detector(
        "GFTT_H",
        "SIFT",
        qualityLevel=(0.001, 0.003, 0.01),
        minDistance=(1.0, 3.0),
        blockSize=(3, 5),
    ),
    _detector("STAR", "SIFT", maxSize=(15, 30, 45), responseThreshold=(2, 5, 15)),
    _detector("HL", "SIFT", corn_thresh=(0.004, 0.01), DOG_thresh=(0.004, 0.01), num_layers=(2, 4)),
    _detector(
        "MSD",
        "DAISY",
        m_th_saliency=(100.0, 250.0),
        m_nms_radius=(3, 5),
        m_compute_orientation=(0, 1),
    ),
    _detector("TBMR", "SIFT", min_area=(30, 60), n_scales=(1, 2, 3)),
    _descriptor("AKAZE", "AKAZE", descriptor_channels=(1, 2, 3)),
    _descriptor("BRISK", "BRISK", patternScale=(0.7, 0.85, 1.0, 1.3)),
    _descriptor("KAZE", "KAZE", extended=(False, True), upright=(False, True)),
    Grid(
        "descriptor",
        "VGG",
        {"desc": (100, 101, 102, 103), "img_normalize": (False, True)},
        "ORB",
        {"scale_factor": (0.75, 2.5, 5.0, 6.25)},
    ),
    _descriptor(
        "DAISY",
        "ORB",
        radius=(8.0, 15.0, 22.0),
        norm=("DAISY.NRM_NONE", "DAISY.NRM_PARTIAL", "DAISY.NRM_SIFT"),
        use_orientation=(False, True),
    ),
    _descriptor(
        "FREAK", "ORB", patternScale=(14.0, 20.0, 28.0), orientationNormalized=(False, True)
    ),
    _descriptor("BRIEF", "ORB", bytes=(16, 32, 64), use_orientation=(False, True)),
    _descriptor("LUCID", "ORB", lucid_kernel=(1, 3, 5), blur_kernel=(2, 6, 10)),
    _descriptor(
        "LATCH", "ORB", bytes=(2, 32, 64), rotationInvariance=(False, True), half_ssd_size=(1, 3)
    ),
    Grid(
        "descriptor",
        "BEBLID",
        {"n_bits": (100, 101)},
        "ORB",
        {"scale_factor": SCALES},
    ),
    Grid(
        "descriptor",
        "TEBLID",
        {"n_bits": (102, 103)},
        "ORB",
        {"scale_factor": SCALES},
    ),
    Grid(
        "descriptor",
        "BOOST",
        {"desc": (100, 101, 102, 300, 301, 302)},
        "ORB",
        {"scale_factor": (0.75, 1.5, 5.0, 6.25)},
    ),
)


GridValues = Mapping[str, Sequence[Value]]
"""Values of parameters to try, by name."""


def as_grid(grid: GridValues | str | Path | None) -> dict[str, tuple[Value, ...]] | None:
    """A grid as it is, or that of a JSON file; None stays."""
    if grid is None:
        return None
    if isinstance(grid, str | Path):
        return read_grid(Path(grid))
    return {name: tuple(values) for name, values in grid.items()}


def read_grid(path: Path) -> dict[str, tuple[Value, ...]]:
    """Values of parameters from a JSON file: ``{"threshold": [5, 10, 20]}``.

    Raises
    ------
    SelectionError
        If it cannot be read or has other content.
    """
    example = 'give a JSON file such as {"threshold": [5, 10, 20]}'
    content = read_json(path, "the grid", SelectionError, example)
    if (
        not isinstance(content, dict)
        or not content
        or not all(
            isinstance(values, list)
            and values
            and all(isinstance(value, bool | int | float | str) for value in values)
            for values in content.values()
        )
    ):
        raise SelectionError(
            f"{path} is not a grid: it must have parameters with lists of values, such as "
            '{"threshold": [5, 10, 20]}'
        )
    return {str(name): tuple(values) for name, values in content.items()}
