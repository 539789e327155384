"""The detectors of OpenCV, one row each. Parameters are those of the thesis (OpenCV 4.11)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from aerocues.methods.parameters import OPENCV, Value
from aerocues.methods.positions import EXACT_POSITIONS, GRAY_INPUT


@dataclass(frozen=True)
class DetectorRow:
    """One detector.

    Parameters
    ----------
    name : str
        As it stands in a combination, upper case.
    factory : str
        Class in ``cv2`` or ``cv2.xfeatures2d`` whose ``create`` makes the detector; for a plug-in
        its entry point, ``module:attribute``.
    parameters : mapping
        Keyword arguments of ``create``; ``"KAZE.DIFF_PM_G2"`` names a constant of a class.
    reference : str
        Where the method was published.
    keypoints_per_megapixel : float
        Typical yield on aerial images, used only to estimate the cost of work before it is done.
    seconds_per_megapixel : float
        Typical time, for the same use.
    unstable : bool
        Whether it is known to corrupt the memory of its process: it then gets a process of its own.
    limit : str or None
        The parameter by which it chooses the best so many keypoints itself.
    threshold : tuple of str and float, or None
        The parameter that the strength of a keypoint must exceed, and the least value that still
        makes sense: below it noise and compression give keypoints. It is lowered where a number of
        keypoints is to be reached.
    bias : str
        How it shifts keypoints as OpenCV has it; empty: not at all. Measured with images that are
        turned by 90 and 180 degrees or mirrored.
    unbiased : mapping
        Parameters besides that put keypoints where they really are, under presets that ask for it.
    of_pairs : bool
        Whether it stands for the positions that a pair matcher finds, and detects nothing.
    on_request : str
        The set of methods in which it is offered: it then takes part only where it, or the set, is
        named. Empty: it always takes part.
    upright : bool
        Whether it expects images that are not turned against each other.
    origin : str
        ``opencv`` or the name of the distribution that brings it.
    unavailable : str or None
        Why it cannot be used here.
    """

    name: str
    factory: str
    parameters: Mapping[str, Value] = field(repr=False)
    reference: str
    keypoints_per_megapixel: float = 10_000
    seconds_per_megapixel: float = 0.5
    unstable: bool = False
    limit: str | None = None
    threshold: tuple[str, float] | None = None
    bias: str = ""
    unbiased: Mapping[str, Value] = field(default_factory=dict)
    of_pairs: bool = False
    on_request: str = ""
    upright: bool = False
    origin: str = OPENCV
    unavailable: str | None = None


_EXACT: Mapping[str, Value] = {EXACT_POSITIONS: True}

DETECTORS: tuple[DetectorRow, ...] = (
    DetectorRow(
        "SIFT",
        "SIFT",
        {
            "nfeatures": 30000,
            "nOctaveLayers": 3,
            "contrastThreshold": 0.04,
            "edgeThreshold": 10.0,
            "sigma": 1.6,
        },
        "Lowe, Distinctive image features from scale-invariant keypoints, IJCV 2004",
        8_000,
        0.25,
        limit="nfeatures",
        threshold=("contrastThreshold", 0.0025),
        bias="0.25 px right and down",
        unbiased={"enable_precise_upscale": True},
    ),
    DetectorRow(
        "AKAZE",
        "AKAZE",
        {
            "descriptor_type": "AKAZE.DESCRIPTOR_MLDB",
            "descriptor_size": 0,
            "descriptor_channels": 3,
            "threshold": 0.001,
            "nOctaves": 4,
            "nOctaveLayers": 4,
            "diffusivity": "KAZE.DIFF_PM_G2",
            "max_points": -1,
        },
        "Alcantarilla et al., Fast explicit diffusion for accelerated features, BMVC 2013",
        3_500,
        0.15,
        threshold=("threshold", 3e-05),
        bias="up to 1 px on all levels but the first, where sizes are odd",
        unbiased=_EXACT,
    ),
    DetectorRow(
        "ORB",
        "ORB",
        {
            "nfeatures": 30000,
            "scaleFactor": 1.2,
            "nlevels": 6,
            "edgeThreshold": 31,
            "firstLevel": 0,
            "WTA_K": 2,
            "scoreType": "ORB.HARRIS_SCORE",
            "patchSize": 31,
            "fastThreshold": 20,
        },
        "Rublee et al., ORB: an efficient alternative to SIFT or SURF, ICCV 2011",
        25_000,
        0.04,
        limit="nfeatures",
        threshold=("fastThreshold", 4),
        bias="up to 1.3 px on all levels but the first",
        unbiased=_EXACT,
    ),
    DetectorRow(
        "BRISK",
        "BRISK",
        {"thresh": 30, "octaves": 3, "patternScale": 1.0},
        "Leutenegger et al., BRISK: binary robust invariant scalable keypoints, ICCV 2011",
        12_000,
        0.3,
        threshold=("thresh", 6),
        bias="up to 1 px on all levels but the first; with the correction up to 0.15 px",
        unbiased=_EXACT,
    ),
    DetectorRow(
        "KAZE",
        "KAZE",
        {
            "extended": False,
            "upright": False,
            "threshold": 0.003,
            "nOctaves": 3,
            "nOctaveLayers": 5,
            "diffusivity": "KAZE.DIFF_CHARBONNIER",
        },
        "Alcantarilla et al., KAZE features, ECCV 2012",
        2_000,
        1.0,
        threshold=("threshold", 0.0001),
    ),
    DetectorRow(
        "FAST",
        "FastFeatureDetector",
        {"threshold": 5, "nonmaxSuppression": True, "type": "FastFeatureDetector.TYPE_5_8"},
        "Rosten and Drummond, Machine learning for high-speed corner detection, ECCV 2006",
        20_000,
        0.01,
        threshold=("threshold", 2),
    ),
    DetectorRow(
        "MSER",
        "MSER",
        {
            "delta": 5,
            "min_area": 20,
            "max_area": 2000,
            "max_variation": 0.15,
            "min_diversity": 0.20,
            "max_evolution": 350,
            "area_threshold": 1.01,
            "min_margin": 0.003,
            "edge_blur_size": 5,
        },
        "Matas et al., Robust wide-baseline stereo from maximally stable extremal regions, "
        "BMVC 2002",
        2_000,
        0.6,
    ),
    DetectorRow(
        "AGAST",
        "AgastFeatureDetector",
        {"threshold": 20, "nonmaxSuppression": True, "type": "AgastFeatureDetector.AGAST_5_8"},
        "Mair et al., Adaptive and generic corner detection based on the accelerated segment "
        "test, ECCV 2010",
        15_000,
        0.01,
        threshold=("threshold", 3),
    ),
    DetectorRow(
        "GFTT",
        "GFTTDetector",
        {
            "maxCorners": 30000,
            "qualityLevel": 0.01,
            "minDistance": 1.0,
            "blockSize": 3,
            "useHarrisDetector": False,
            "k": 0.04,
        },
        "Shi and Tomasi, Good features to track, CVPR 1994",
        25_000,
        0.03,
        limit="maxCorners",
        threshold=("qualityLevel", 0.0003),
    ),
    DetectorRow(
        "GFTT_H",
        "GFTTDetector",
        {
            "maxCorners": 30000,
            "qualityLevel": 0.01,
            "minDistance": 1.0,
            "blockSize": 3,
            "useHarrisDetector": True,
            "k": 0.04,
        },
        "Harris and Stephens, A combined corner and edge detector, AVC 1988",
        5_000,
        0.03,
        limit="maxCorners",
        threshold=("qualityLevel", 1e-05),
    ),
    DetectorRow(
        "STAR",
        "StarDetector",
        {
            "maxSize": 15,
            "responseThreshold": 5,
            "lineThresholdProjected": 60,
            "lineThresholdBinarized": 30,
            "suppressNonmaxSize": 3,
        },
        "Agrawal et al., CenSurE: center surround extremas, ECCV 2008",
        10_000,
        0.03,
        threshold=("responseThreshold", 1),
    ),
    DetectorRow(
        "HL",
        "HarrisLaplaceFeatureDetector",
        {
            "numOctaves": 3,
            "corn_thresh": 0.004,
            "DOG_thresh": 0.004,
            "maxCorners": 30000,
            "num_layers": 2,
        },
        "Mikolajczyk and Schmid, Scale and affine invariant interest point detectors, IJCV 2004",
        15_000,
        3.0,
        limit="maxCorners",
        threshold=("corn_thresh", 0.0001),
        bias="0.5 px right and down; of colour images it sees the left third, three times as wide",
        unbiased={**_EXACT, GRAY_INPUT: True},
    ),
    DetectorRow(
        "MSD",
        "MSDDetector",
        {
            "m_patch_radius": 3,
            "m_search_area_radius": 5,
            "m_nms_radius": 5,
            "m_nms_scale_radius": 0,
            "m_th_saliency": 100.0,
            "m_kNN": 4,
            "m_scale_factor": 1.25,
            "m_n_scales": -1,
            "m_compute_orientation": 0,
        },
        "Tombari and Di Stefano, Interest points via maximal self-dissimilarities, ACCV 2014",
        5_000,
        4.0,
        threshold=("m_th_saliency", 10.0),
        bias="0.5 px right and down on the finest level, up to 1 px on the others",
        unbiased=_EXACT,
    ),
    DetectorRow(
        "TBMR",
        "TBMR",
        {"min_area": 30, "max_area_relative": 0.01, "scale_factor": 1.25, "n_scales": 2},
        "Xu et al., Tree-based Morse regions, IEEE TIP 2014",
        7_000,
        0.5,
        unstable=True,
        bias="the second level at 0.64 of its x and y",
        unbiased=_EXACT,
    ),
)
