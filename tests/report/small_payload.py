"""A small payload that follows the page's contract, with names that try to break out of it."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tests.report.small_models import small_clouds, small_models

HARMFUL = '<img src=x onerror="window.harmed = true">'
BREAKING = "</script><script>window.harmed = true</script>"
PIXEL = (
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk"
    "+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)
METHODS = (
    ("SIFT", "SIFT", "L2", "BF"),
    ("SIFT", "SIFT", "L2", "FLANN"),
    ("SIFT", "DAISY", "L2", "BF"),
    ("ORB", "ORB", "HAM", "BF"),
    ("ORB", "ORB", "HAM", "FLANN"),
    ("ORB", "BEBLID", "HAM", "BF"),
    ("AKAZE", "AKAZE", "HAM", "BF"),
    ("KAZE", "KAZE", "L2", "BF"),
    ("GFTT", "DAISY", "L2", "BF"),
    ("GFTT_H", "DAISY", "L2", "BF"),
    ("<b>MINE", "ORB", "HAM", "BF"),
    ("MSER", "SIFT", "L2", "BF"),
)
STATUSES = ["ok", "no_keypoints", "chance", "error", "not measured"]
RACE: dict[str, Any] = {
    "dataset": "images",
    "objective": "balanced",
    "title": "good 3D models, in reasonable time",
    "best": "KAZE-KAZE-L2-BF",
    "leader": "ORB-ORB-HAM-BF",
    "probability": 0.4,
    "ended": "budget",
    "seconds": 90.0,
    "combinations": 466,
    "measured": 12,
    "measurements": 30,
    "pairs": 8,
    "candidates": 153,
    "ranked": [
        {
            "combination": "ORB-ORB-HAM-BF",
            "score": 0.8,
            "probability": 0.4,
            "pairs": 2,
            "succeeded": 2,
        }
    ],
    "final": None,
}
CRITERIA = {"precision": "higher", "inliers": "higher", "seconds_per_1k_inliers": "lower"}


def floats(values: ArrayLike) -> dict[str, str]:
    """Numbers as the page reads them."""
    return {"f32": base64.b64encode(np.asarray(values, "<f4").tobytes()).decode()}


def small_bytes(values: ArrayLike) -> dict[str, str]:
    """Small whole numbers as the page reads them."""
    return {"u8": base64.b64encode(np.asarray(values, np.uint8).tobytes()).decode()}


def names_of(methods: tuple[tuple[str, ...], ...] = METHODS) -> list[str]:
    """Of the combinations."""
    return ["-".join(method) for method in methods]


def small_payload() -> dict[str, Any]:
    """Two data sets and machines with everything, and an imported one with the least."""
    full = entry_of("images", seed=0, name=f"images {HARMFUL}")
    full["models"] = small_models(METHODS, HARMFUL)
    other = entry_of("images", seed=1, name="images (other)")
    return {
        **frame_of([full, other, imported_entry()]),
        "comparison": comparison_of([full, other]),
        "machines": [machines_of(full["name"], other["name"])],
        "images": {key: {"src": PIXEL, "width": 60, "height": 40, "scale": 0.5} for key in "ab"},
        "pictures": [picture_of(full, 3, 0), picture_of(full, 0, 0), picture_of(full, 3, 5)],
        "clouds": small_clouds(full["name"]),
        "maps": [map_of(full)],
    }


def map_of(entry: dict[str, Any]) -> dict[str, Any]:
    """The images of an entry, side by side."""
    names = ["a.png", *(pair["image_2"] for pair in entry["pairs"])]
    images = []
    for place, name in enumerate(names):
        x, y = 10.0 * place, float(place % 3)
        ground = [[x - 8, y + 6], [x + 8, y + 6], [x + 8, y - 6], [x - 8, y - 6]]
        images.append({"name": name, "x": x, "y": y, "src": PIXEL, "ground": ground})
    return {"entry": entry["name"], "known": "gps", "images": images}


def lone_payload() -> dict[str, Any]:
    """One combination on one pair of one data set."""
    return frame_of([imported_entry(METHODS[:1], pairs=1)])


def frame_of(entries: list[dict[str, Any]]) -> dict[str, Any]:
    """A payload of entries with nothing that compares them."""
    return {
        "title": f"Small report {BREAKING} {HARMFUL}",
        "made": "2026-01-02T03:04:05",
        "version": "0.1.0",
        "entries": entries,
        "comparison": None,
        "machines": [],
        "incompatible": {"KAZE-SIFT-HAM-BF": "SIFT <descriptors> are floats & HAM needs bits"},
        "images": {},
        "pictures": [],
        "clouds": [],
        "maps": [],
        "method": {
            "columns": [
                {
                    "name": "precision",
                    "unit": "ratio",
                    "definition": "inliers / matches",
                    "better": "higher",
                }
            ],
            "criteria": [],
            "statuses": [{"name": "ok", "meaning": "a model was found"}],
            "words": [{"word": "inlier", "meaning": f"a meaning {HARMFUL}"}],
            "citation": f"Someone, {HARMFUL}",
            "notes": [f"a note {HARMFUL}"],
        },
    }


def entry_of(dataset: str, seed: int, name: str) -> dict[str, Any]:
    """An entry with ground truth, stage times, curves and everything that validates it."""
    entry = imported_entry(METHODS, pairs=8, seed=seed)
    generator = np.random.default_rng(seed)
    count = (len(METHODS), 8)
    precision = _decoded(entry["columns"]["precision"]).reshape(count)
    stages = generator.uniform(0.01, 1, (4, *count))
    added = {
        "matches": ("count", "higher", generator.integers(100, 5000, count)),
        "recall": ("ratio", "higher", precision * 0.4),
        "gt_precision@3": ("ratio", "higher", precision * 0.9),
        "homography_auc@3": ("ratio", "higher", precision * 0.7),
        "detect_seconds": ("s", "lower", stages[0]),
        "match_seconds": ("s", "lower", stages[2]),
    }
    entry["columns"] |= {key: _column(*column) for key, column in added.items()}
    entry["medians"] |= {
        stage: np.median(times, axis=1).tolist()
        for stage, times in zip(("detect", "describe", "match", "verify"), stages, strict=True)
    }
    entry |= {"name": name, "dataset": dataset, "timing": "shared", "geometry": "homography"}
    entry["curves"] = [
        {"name": "rotation", "axis": "degrees", "pairs": [0, 1, 2, 3], "x": [15, 30, 45, 60]},
        {"name": "scale", "axis": "factor", "pairs": [4, 5, 6, 7], "x": [0.5, 0.7, 1.3, 1.5]},
    ]
    entry["validation"] = _validation(entry)
    return entry


def imported_entry(
    methods: tuple[tuple[str, ...], ...] = METHODS, pairs: int = 4, seed: int = 2
) -> dict[str, Any]:
    """An entry of which little is known: no stages, no ground truth, no curves."""
    generator = np.random.default_rng(seed)
    count = (len(methods), pairs)
    level = np.linspace(0.9, 0.2, len(methods))[:, None]
    precision = np.clip(level + generator.normal(0, 0.05, count), 0.01, 0.99)
    status = np.zeros(count, np.uint8)
    if len(methods) > 1:
        status[-1, 0] = STATUSES.index("error")
        precision[-1, 0] = np.nan
    inliers = precision * 2000
    seconds = generator.uniform(0.05, 2, count)
    detector, descriptor, norm, matcher = (list(column) for column in zip(*methods, strict=True))
    return {
        "name": "imported",
        "dataset": "imported",
        "machine": f"machine {HARMFUL}",
        "preset": "thesis",
        "timing": "unknown",
        "geometry": None,
        "combinations": names_of(methods),
        "detector": detector,
        "descriptor": descriptor,
        "norm": norm,
        "matcher": matcher,
        "pairs": [
            {
                "pair": pair,
                "sequence": HARMFUL,
                "image_1": "a.png",
                "image_2": f"{pair}.png",
                "step": None,
            }
            for pair in range(pairs)
        ],
        "curves": [],
        "statuses": STATUSES,
        "status": small_bytes(status),
        "columns": {
            "precision": _column("ratio", "higher", precision),
            "inliers": _column("count", "higher", inliers),
            "seconds_per_1k_inliers": _column("s", "lower", 1000 * seconds / inliers),
            "total_seconds": _column("s", "lower", seconds),
        },
        "score": _score(precision, inliers, seconds, pairs),
        "preset_scores": {"thesis": np.nanmean(precision, axis=1).tolist()},
        "megabytes": np.linspace(0.1, 4, len(methods)).tolist(),
        "race": None,
        "medians": {
            **dict.fromkeys(("detect", "describe", "match", "verify"), [None] * len(methods)),
            "total": np.median(seconds, axis=1).tolist(),
        },
        "validation": _no_validation(),
        "models": None,
        "counts": {"ok": int((status == 0).sum()), "error": int((status != 0).sum())},
        "failures": [
            {
                "status": "error",
                "detector": "MSER",
                "descriptor": "SIFT",
                "rows": 1,
                "message": f"it failed {HARMFUL}",
            }
        ],
        "failures_left_out": 0,
        "excluded": [
            {"reason": "cannot run & <never> will", "combinations": ["a", "b", "c"], "pairs": 8}
        ],
        "run": {"dataset": {"name": HARMFUL}, "versions": {"aerocues": "0.1.0"}},
    }


def _column(unit: str, better: str, values: NDArray[Any]) -> dict[str, Any]:
    return {"unit": unit, "better": better, "definition": HARMFUL, "values": floats(values)}


def _decoded(column: dict[str, Any]) -> NDArray[np.float32]:
    return np.frombuffer(base64.b64decode(column["values"]["f32"]), "<f4")


def _score(
    precision: NDArray[Any], inliers: NDArray[Any], seconds: NDArray[Any], pairs: int
) -> dict[str, Any]:
    means = {
        "precision": np.nanmean(precision, axis=1),
        "inliers": np.nanmean(inliers, axis=1),
        "seconds_per_1k_inliers": np.nanmean(1000 * seconds / inliers, axis=1),
    }
    score = means["precision"]
    number = len(score)
    rank = (-score).argsort().argsort() + 1
    best = int(rank.argmin())
    weights = [0.5, 0.3, 0.2]
    return {
        "criteria": [
            {
                "name": name,
                "better": better,
                "description": HARMFUL,
                "aspect": aspect,
                "reconstruction": False,
            }
            for (name, better), aspect in zip(
                CRITERIA.items(), ("accuracy", "quantity", "speed"), strict=True
            )
        ],
        "rank": rank.tolist(),
        "rank_low": np.maximum(rank - 1, 1).tolist(),
        "rank_high": (rank + 2).tolist(),
        "score": score.tolist(),
        "score_low": (score - 0.05).tolist(),
        "score_high": (score + 0.05).tolist(),
        "probability_best": [0.8 if place == 1 else 0.01 for place in rank.tolist()],
        "probability_top": [1.0 if place <= 5 else 0.0 for place in rank.tolist()],
        "p_value": [None if place == 1 else min(1, 0.3 / place) for place in rank.tolist()],
        "success_rate": np.isfinite(precision).mean(axis=1).tolist(),
        "repeats": [pairs] * number,
        "means": {name: values.tolist() for name, values in means.items()},
        "normalised": {name: values.tolist() for name, values in means.items()},
        "weights": {
            "methods": ["entropy", "aggregate"],
            "values": {"entropy": weights, "aggregate": weights},
        },
        "settings": {
            "resamples": 1000,
            "resampled": "repeat",
            "failures": "worst",
            "criteria": list(CRITERIA),
            "top_k": 5,
            "good": 0.9,
        },
        "best": best,
        "indistinguishable": [1, 2] if number > 2 else [],
        "untested": [],
        "units": pairs,
        "fastest_good": 1 if number > 1 else None,
        "best_binary": 3 if number > 3 else None,
    }


def _no_validation() -> dict[str, Any]:
    lone = {"names": ["0.5"], "correlation": [[None]], "best": ["SIFT-SIFT-L2-BF"]}
    return {
        "alpha": lone,
        "aggregation": lone,
        "criterion_left_out": lone,
        "agreement": {"unavailable": "pymcdm is not installed"},
        "criteria_correlation": {"names": ["precision"], "correlation": [[None]]},
        "hierarchies": {},
        "pareto": {"criteria": [], "front": []},
        "rank_reversal": None,
        "critical_difference": {"unavailable": "one alternative cannot be ranked"},
    }


def _validation(entry: dict[str, Any]) -> dict[str, Any]:
    variants = {
        "names": ["0.1", "0.5", "0.75"],
        "correlation": [[1, 0.9, 0.8], [0.9, 1, 0.95], [0.8, 0.95, 1]],
        "best": [entry["combinations"][0]] * 2 + [entry["combinations"][1]],
    }
    matrix = {
        "names": list(CRITERIA),
        "correlation": [[1, 0.5, -0.4], [0.5, 1, None], [-0.4, None, 1]],
    }
    component = {
        "name": "SIFT",
        "mean": 0.6,
        "max": 0.9,
        "standard_deviation": 0.1,
        "alternatives": 3,
        "evaluations": 24,
        "best": entry["combinations"][0],
    }
    return {
        "alpha": variants,
        "aggregation": variants,
        "criterion_left_out": {**variants, "names": ["all criteria", "without a", "without b"]},
        "agreement": {**variants, "names": ["CUES", "TOPSIS", "VIKOR"]},
        "criteria_correlation": matrix,
        "hierarchies": {"detectors": [component, {**component, "name": "<b>MINE"}]},
        "pareto": {"criteria": ["seconds_per_1k_inliers", "precision"], "front": [0, 1]},
        "rank_reversal": {
            "share": 0.1,
            "rounds": 100,
            "mean_shift": 0.4,
            "largest_shift": 5,
            "spearman_mean": 0.99,
            "spearman_lowest": 0.98,
            "best_kept": 0.99,
        },
        "critical_difference": {
            "alternatives": entry["combinations"][:4],
            "mean_ranks": [1.5, 2.0, 2.8, 3.7],
            "critical_difference": 1.1,
            "groups": [[0, 1], [1, 2]],
            "units": 8,
            "chi_square": 12.5,
            "p_value": 0.006,
            "f_statistic": 7.6,
            "f_p_value": 0.001,
        },
    }


def comparison_of(entries: list[dict[str, Any]]) -> dict[str, Any]:
    """Two rankings side by side."""
    scores = [entry["score"]["score"] for entry in entries]
    ranks = [entry["score"]["rank"] for entry in entries]
    rows = [
        {
            "alternative": name,
            "mean": float(np.mean([scores[0][a], scores[1][a]])),
            "min": min(scores[0][a], scores[1][a]),
            "spread": abs(scores[0][a] - scores[1][a]),
            "mean_rank": (ranks[0][a] + ranks[1][a]) / 2,
            "worst_rank": max(ranks[0][a], ranks[1][a]),
            "rankings": 2,
            "scores": [scores[0][a], scores[1][a]],
            "ranks": [ranks[0][a], ranks[1][a]],
        }
        for a, name in enumerate(entries[0]["combinations"])
    ]
    return {
        "names": [entry["name"] for entry in entries],
        "spearman": [[1, 0.9], [0.9, 1]],
        "kendall": [[1, 0.8], [0.8, 1]],
        "shared": [[12, 12], [12, 12]],
        "versatility": rows,
    }


def machines_of(first: str, second: str) -> dict[str, Any]:
    """The same images on two machines."""
    times = {
        "stage": "total",
        "rows": 96,
        "first_seconds": 0.2,
        "second_seconds": 0.6,
        "ratio": 3.1,
        "ratio_low": 2.0,
        "ratio_high": 5.0,
        "rank_correlation": 0.95,
    }
    return {"first": first, "second": second, "spearman": 0.9, "kendall": 0.8, "times": [times]}


def picture_of(entry: dict[str, Any], combination: int, pair: int) -> dict[str, Any]:
    """Twenty matches, every other one an inlier."""
    generator = np.random.default_rng(pair)
    points = generator.uniform(0, 80, (20, 2))
    return {
        "entry": entry["name"],
        "combination": entry["combinations"][combination],
        "pair": pair,
        "image_1": "a",
        "image_2": "b",
        "keypoints_1": floats(points),
        "keypoints_2": floats(points),
        "keypoints_every": 3,
        "matches": floats(np.hstack([points, points])),
        "inlier": small_bytes(np.arange(20) % 2),
        "matches_every": 2,
        "right": small_bytes(np.arange(20) % 4 != 1),
        "judge": "reference",
        "why": f"worst pair {HARMFUL}",
        "role": "best",
        "note": None,
        "figures": {"status": "ok", "precision": 0.5, "inliers": 20, "matches": 40},
    }
