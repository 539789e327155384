"""The objects of OpenCV hold the parameters of DESIGN's table, read back from them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from aerocues.errors import MethodUnavailableError
from aerocues.methods.combination import NONE
from aerocues.methods.making import make_descriptor, make_detector, make_matcher
from aerocues.methods.parameters import Value, create_opencv, opencv_class
from aerocues.methods.registry import Methods, opencv_methods

Values = dict[str, Any]

SIFT: Values = {
    "NFeatures": 30000,
    "NOctaveLayers": 3,
    "ContrastThreshold": 0.04,
    "EdgeThreshold": 10.0,
    "Sigma": 1.6,
}
AKAZE: Values = {
    "DescriptorType": "MLDB",
    "DescriptorSize": 0,
    "DescriptorChannels": 3,
    "Threshold": 0.001,
    "NOctaves": 4,
    "NOctaveLayers": 4,
    "Diffusivity": "PM_G2",
    "MaxPoints": -1,
}
ORB: Values = {
    "MaxFeatures": 30000,
    "ScaleFactor": 1.2,
    "NLevels": 6,
    "EdgeThreshold": 31,
    "FirstLevel": 0,
    "WTA_K": 2,
    "ScoreType": "HARRIS",
    "PatchSize": 31,
    "FastThreshold": 20,
}
BRISK: Values = {"Threshold": 30, "Octaves": 3, "PatternScale": 1.0}
KAZE: Values = {
    "Extended": False,
    "Upright": False,
    "Threshold": 0.003,
    "NOctaves": 3,
    "NOctaveLayers": 5,
    "Diffusivity": "CHARBONNIER",
}
GFTT: Values = {
    "MaxFeatures": 30000,
    "QualityLevel": 0.01,
    "MinDistance": 1.0,
    "BlockSize": 3,
    "K": 0.04,
}

# Values that OpenCV numbers: DIFF_PM_G1 0, PM_G2 1, WEICKERT 2, CHARBONNIER 3; MLDB is 5.
NAMED = {"MLDB": 5, "PM_G2": 1, "CHARBONNIER": 3, "HARRIS": 0, "NRM_NONE": 100}

DETECTORS: dict[str, Values] = {
    "SIFT": SIFT,
    "AKAZE": AKAZE,
    "ORB": ORB,
    "BRISK": BRISK,
    "KAZE": KAZE,
    "FAST": {"Threshold": 5, "NonmaxSuppression": True, "Type": 0},
    "MSER": {
        "Delta": 5,
        "MinArea": 20,
        "MaxArea": 2000,
        "MaxVariation": 0.15,
        "MinDiversity": 0.20,
        "MaxEvolution": 350,
        "AreaThreshold": 1.01,
        "MinMargin": 0.003,
        "EdgeBlurSize": 5,
    },
    "AGAST": {"Threshold": 20, "NonmaxSuppression": True, "Type": 0},
    "GFTT": {**GFTT, "HarrisDetector": False},
    "GFTT_H": {**GFTT, "HarrisDetector": True},
    "STAR": {
        "MaxSize": 15,
        "ResponseThreshold": 5,
        "LineThresholdProjected": 60,
        "LineThresholdBinarized": 30,
        "SuppressNonmaxSize": 3,
    },
    "HL": {
        "NumOctaves": 3,
        "CornThresh": 0.004,
        "DOGThresh": 0.004,
        "MaxCorners": 30000,
        "NumLayers": 2,
    },
    "MSD": {
        "PatchRadius": 3,
        "SearchAreaRadius": 5,
        "NmsRadius": 5,
        "NmsScaleRadius": 0,
        "ThSaliency": 100.0,
        "KNN": 4,
        "ScaleFactor": 1.25,
        "NScales": -1,
        "ComputeOrientation": False,
    },
    "TBMR": {"MinArea": 30, "MaxAreaRelative": 0.01, "ScaleFactor": 1.25, "NScales": 2},
}

DESCRIPTORS: dict[str, Values] = {
    "SIFT": SIFT,
    "AKAZE": AKAZE,
    "ORB": ORB,
    "BRISK": BRISK,
    "KAZE": KAZE,
    "VGG": {
        "Sigma": 1.4,
        "UseNormalizeImage": False,
        "UseScaleOrientation": True,
        "ScaleFactor": 6.25,
        "UseNormalizeDescriptor": False,
    },
    "DAISY": {
        "Radius": 15.0,
        "QRadius": 3,
        "QTheta": 8,
        "QHist": 8,
        "Norm": "NRM_NONE",
        "Interpolation": True,
        "UseOrientation": False,
    },
    "FREAK": {
        "OrientationNormalized": True,
        "ScaleNormalized": True,
        "PatternScale": 20.0,
        "NOctaves": 3,
    },
    "BRIEF": {"DescriptorSize": 16, "UseOrientation": True},
    "LUCID": {"LucidKernel": 3, "BlurKernel": 6},
    "LATCH": {"Bytes": 2, "RotationInvariance": True, "HalfSSDsize": 1, "Sigma": 1.4},
    "BEBLID": {"ScaleFactor": 6.25},
    "TEBLID": {},
    "BOOST": {"UseScaleOrientation": True, "ScaleFactor": 6.25},
}

# What no getter tells, as the table states it: VGG_48, SIZE_512_BITS, SIZE_256_BITS, BGM.
NO_GETTER: dict[str, Values] = {
    "VGG": {"desc": 103},
    "BEBLID": {"scale_factor": 6.25, "n_bits": 100},
    "TEBLID": {"scale_factor": 6.25, "n_bits": 102},
    "BOOST": {"desc": 100},
}

BYTES = {
    "SIFT": 128 * 4,
    "AKAZE": 61,
    "ORB": 32,
    "BRISK": 64,
    "KAZE": 64 * 4,
    "VGG": 48 * 4,
    "DAISY": 200 * 4,
    "FREAK": 64,
    "BRIEF": 16,
    "LUCID": 147,
    "LATCH": 2,
    "BEBLID": 64,
    "TEBLID": 32,
    "BOOST": 32,
}


@pytest.fixture(scope="module")
def methods() -> Methods:
    """The methods of the thesis, without those on request."""
    every = opencv_methods()
    return replace(
        every,
        detectors={name: row for name, row in every.detectors.items() if not row.on_request},
        descriptors={name: row for name, row in every.descriptors.items() if name in BYTES},
        norms={name: row for name, row in every.norms.items() if name != NONE},
        matchers={name: row for name, row in every.matchers.items() if not row.on_request},
    )


def assert_holds(native: Any, expected: Values) -> None:
    for name, value in expected.items():
        got = getattr(native, f"get{name}")()
        assert got == pytest.approx(NAMED.get(value, value), rel=1e-6), name


def test_the_tables_hold_the_fourteen_of_each(methods: Methods) -> None:
    assert list(methods.detectors) == list(DETECTORS)
    assert list(methods.descriptors) == list(DESCRIPTORS) == list(BYTES)
    assert list(methods.norms) == ["L2", "HAM"]
    assert list(methods.matchers) == ["BF", "FLANN"]


@pytest.mark.opencv_versions
@pytest.mark.parametrize("name", DETECTORS)
def test_detectors_are_made_with_the_parameters_of_the_table(methods: Methods, name: str) -> None:
    row = methods.detectors[name]
    assert make_detector(methods, name)
    assert_holds(create_opencv(row.factory, row.parameters), DETECTORS[name])


@pytest.mark.opencv_versions
@pytest.mark.parametrize("name", DESCRIPTORS)
def test_descriptors_are_made_with_the_parameters_of_the_table(methods: Methods, name: str) -> None:
    row = methods.descriptors[name]
    native = create_opencv(row.factory, row.parameters)
    assert make_descriptor(methods, name)
    assert_holds(native, DESCRIPTORS[name])
    for parameter, value in NO_GETTER.get(name, {}).items():
        assert row.parameters[parameter] == value
    element = np.dtype(row.dtype).itemsize
    assert native.descriptorSize() * element == row.columns * element == BYTES[name]


def test_every_parameter_is_read_back_or_stated(methods: Methods) -> None:
    def check(parameters: Mapping[str, Value], getters: Values, stated: Values) -> None:
        both = {"scale_factor"} & stated.keys() if "ScaleFactor" in getters else set()
        assert len(parameters) == len(getters) + len(stated.keys() - both), parameters

    for name, row in methods.detectors.items():
        check(row.parameters, DETECTORS[name], {})
    for name, other in methods.descriptors.items():
        check(other.parameters, DESCRIPTORS[name], NO_GETTER.get(name, {}))


def test_flann_has_the_parameters_of_the_table(methods: Methods) -> None:
    assert methods.matchers["FLANN"].parameters == {
        "L2": {"algorithm": 1, "trees": 5, "checks": 50},
        "HAM": {
            "algorithm": 6,
            "table_number": 6,
            "key_size": 12,
            "multi_probe_level": 1,
            "checks": 50,
        },
    }
    for name, norm in (("BF", "L2"), ("BF", "HAM"), ("FLANN", "L2"), ("FLANN", "HAM")):
        assert make_matcher(methods, name, norm)


def test_everything_says_where_it_was_published(methods: Methods) -> None:
    stated = [(r.reference, r.origin, r.unavailable) for r in methods.detectors.values()]
    stated += [(r.reference, r.origin, r.unavailable) for r in methods.descriptors.values()]
    stated += [(r.reference, r.origin, r.unavailable) for r in methods.matchers.values()]
    for reference, origin, unavailable in stated:
        assert reference
        assert (origin, unavailable) == ("opencv", None)


def test_what_this_opencv_lacks_is_unavailable_with_the_next_step() -> None:
    with pytest.raises(MethodUnavailableError, match="SURPRISE"):
        opencv_class("SURPRISE")
    with pytest.raises(MethodUnavailableError, match="ORB"):
        create_opencv("ORB", {"colour": 1})
    with pytest.raises(MethodUnavailableError, match="KAZE"):
        create_opencv("KAZE", {"diffusivity": "KAZE.DIFF_NONE"})


def test_classes_are_found_where_this_version_keeps_them() -> None:
    for name in ("AKAZE", "KAZE", "BRISK", "AgastFeatureDetector"):
        owner = cv2 if hasattr(cv2, name) else cv2.xfeatures2d
        assert opencv_class(name) is getattr(owner, name)
