"""Settings of tools with a fixed list of features."""

from __future__ import annotations

from pathlib import Path

import pytest

import aerocues
from aerocues.exports import odm_options, rtabmap
from aerocues.exports.nearest import nearest
from aerocues.exports.recipe import Measured
from aerocues.methods.combination import Combination
from aerocues.methods.plugins import installed_methods
from aerocues.methods.presets import preset_named

MEASURED = Measured(preset_named("default"), max_keypoints=2000)
# Names in `Parameters.h` of RTAB-Map 0.23.
KNOWN = {
    "Vis": ("FeatureType", "MaxFeatures", "CorNNType"),
    "Kp": ("DetectorStrategy",),
    "SIFT": ("NOctaveLayers", "ContrastThreshold", "EdgeThreshold", "Sigma", "PreciseUpscale"),
    "BRIEF": ("Bytes",),
    "FAST": ("Threshold", "NonmaxSuppression"),
    "GFTT": ("QualityLevel", "MinDistance", "BlockSize", "UseHarrisDetector", "K"),
    "ORB": (
        *("ScaleFactor", "NLevels", "EdgeThreshold", "FirstLevel", "WTA_K", "ScoreType"),
        "PatchSize",
    ),
    "FREAK": ("OrientationNormalized", "ScaleNormalized", "PatternScale", "NOctaves"),
    "BRISK": ("Thresh", "Octaves", "PatternScale"),
    "KAZE": ("Extended", "Upright", "Threshold", "NOctaves", "NOctaveLayers", "Diffusivity"),
}


def arguments(text: str) -> dict[str, str]:
    words = [line.split() for line in text.splitlines() if not line.startswith("#")]
    return {name.removeprefix("--"): value for name, value in words}


@pytest.mark.parametrize("kind", rtabmap.FEATURES, ids="-".join)
def test_rtabmap_knows_every_argument(kind: tuple[str, str]) -> None:
    norm = "L2" if installed_methods().descriptors[kind[1]].dtype == "float32" else "HAM"
    found = arguments(rtabmap.rtabmap_settings(Combination(*kind, norm, "BF"), MEASURED, None))
    assert found["Vis/FeatureType"] == found["Kp/DetectorStrategy"] == str(rtabmap.FEATURES[kind])
    assert found["Vis/MaxFeatures"] == "2000"
    assert found["Vis/CorNNType"] == "5"
    for name in found:
        group, _, parameter = name.partition("/")
        assert parameter in KNOWN[group]


def test_values_are_those_of_the_preset() -> None:
    text = rtabmap.rtabmap_settings(Combination("KAZE", "KAZE", "L2", "FLANN"), MEASURED, None)
    found = arguments(text)
    assert found["KAZE/Diffusivity"] == "3"
    assert found["KAZE/Extended"] == "false"
    assert found["KAZE/Threshold"] == "0.003"
    assert found["Vis/CorNNType"] == "1"


@pytest.mark.parametrize(
    ("wanted", "expected"),
    [
        ("BRISK-BRISK-HAM-BF", "BRISK-BRISK-HAM-BF"),
        ("STAR-BRISK-HAM-EXACT", "BRISK-BRISK-HAM-EXACT"),
        ("ORB-BEBLID-HAM-BF", "ORB-ORB-HAM-BF"),
        ("STAR-LATCH-HAM-BF", "SIFT-SIFT-L2-BF"),
    ],
)
def test_the_nearest_shares_descriptor_or_detector(wanted: str, expected: str) -> None:
    found = nearest(Combination.parse(wanted), rtabmap.FEATURES, None)
    assert str(found.combination) == expected
    assert bool(found.reason) == (wanted != expected)


def test_the_best_that_was_measured_is_nearest() -> None:
    ranked = ["STAR-BRISK-HAM-BF", "ORB-BEBLID-HAM-BF", "KAZE-KAZE-L2-BF", "BRISK-BRISK-HAM-BF"]
    found = nearest(Combination.parse(ranked[0]), rtabmap.FEATURES, ranked)
    assert str(found.combination) == "KAZE-KAZE-L2-BF"
    assert "3 of 4" in found.reason


def test_odm_gets_its_own_words() -> None:
    text = odm_options.odm_options(Combination.parse("ORB-ORB-HAM-FLANN"), MEASURED, None)
    assert text.splitlines()[-1] == (
        "--feature-type orb --matcher-type flann --min-num-features 2000"
    )
    text = odm_options.odm_options(Combination.parse("ORB-BEBLID-HAM-BF"), MEASURED, None)
    assert "aerocues use ORB-BEBLID-HAM-BF IMAGES --as odm" in text
    assert text.splitlines()[-1].startswith("--feature-type orb --matcher-type bruteforce")


@pytest.mark.slow
def test_results_tell_which_near_one_was_measured(finished: Path, tmp_path: Path) -> None:
    file = tmp_path / "settings.txt"
    used = aerocues.use(
        combination="STAR-BRISK-HAM-BF", output=file, target="odm-options", results=finished
    )
    assert "was measured" in used.text
    assert file.read_text() == used.text
