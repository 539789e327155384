"""Makes the preset `tuned` that aerocues brings along: python benchmarks/tuned_preset.py WORK.

Searched on a simulated flight and the Oxford sequences, judged on nine other scenes: two of
HPatches, five projects and simulated flights over two other places. The real images stand beside
the project (AEROCUES_SHARED_DATA). Detectors are searched with the strongest 8,000 keypoints of an
image, descriptors with the strongest 2,000. Takes about an hour and a half on two cores;
interrupted, it goes on.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

PRESET = Path(__file__).parent.parent / "src/aerocues/methods/tuned.json"
QUICK = "AKAZE BRISK KAZE DAISY FREAK BRIEF LUCID LATCH BEBLID TEBLID"
SEARCHES = (
    ("detectors", "detector:all", 8000),
    ("descriptors", ",".join(f"descriptor:{name}" for name in QUICK.split()), 2000),
    ("slow-descriptors", "descriptor:VGG,descriptor:BOOST", 2000),
)
"""Name of the file, methods and keypoints; what takes half of the time comes last."""
JUDGING = ("fields", "industrial")
"""Scenes of simulated flights that settings are judged on."""
PAIRS = 20
"""Of the search, and as many to judge by: each project is among them."""
GROUPS = ("detectors", "descriptors", "on_detectors", "thresholds")


def aerocues(*words: object) -> None:
    subprocess.run([sys.executable, "-m", "aerocues", *map(str, words)], check=True)


def search(work: Path, name: str, methods: str, keypoints: int) -> Path:
    """One search; the file of its preset."""
    data = Path(os.environ.get("AEROCUES_SHARED_DATA", "../shared/data"))
    made = work / f"{name}.json"
    judges = (
        f"hpatches:{data / 'hpatches'}",
        f"uav:{data / 'pairs'}",
        *(f"simulated:{work / scene}" for scene in JUDGING),
    )
    aerocues(
        *("tune", methods, f"oxford:{data / 'oxford'}", f"simulated:{work / 'flight'}"),
        *(word for judge in judges for word in ("--validate", judge)),
        *("-o", made, "--max-keypoints", keypoints, "--max-pairs", PAIRS),
    )
    return made


def main() -> None:
    work = Path(sys.argv[1])
    work.mkdir(parents=True, exist_ok=True)
    aerocues("simulate", "-o", work / "flight", "--survey", "airsimnh", "--subset", "Layer3")
    for scene in JUDGING:
        flight = ("--survey", "mini", "--size", "1000x666", "--scene", scene)
        aerocues("simulate", "-o", work / scene, *flight)
    parts = [json.loads(search(work, *each).read_text()) for each in SEARCHES]
    merged = {
        "name": "tuned",
        "title": "parameters searched on simulated and Oxford images; a model must beat chance",
        "chance_test": True,
        **{group: {k: v for part in parts for k, v in part[group].items()} for group in GROUPS},
        "made": [part["made"] for part in parts],
    }
    PRESET.write_text(json.dumps(merged, indent=1) + "\n")
    print(PRESET)


if __name__ == "__main__":
    main()
