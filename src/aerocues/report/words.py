"""Words of the page and what they mean, as in the glossary of the guide.

Words with a second meaning on the page, such as the reference of clouds, are not among them.
"""

from __future__ import annotations

from collections.abc import Mapping

WORDS: Mapping[str, str] = {
    "baseline": "COLMAP's default features and matching, built beside the leaders with the same "
    "mapper, so that you see what a choice gains.",
    "beyond chance": "What is left after the inliers that shuffled matches would also give are "
    "taken away.",
    "coverage": "Share of the cells of a 16 x 16 grid on image 1 that hold a right match.",
    "CUES": "Composite Unsupervised Efficiency Score: weighted sum of the normalised criteria, "
    "with weights from the data.",
    "expected quality": "Of a model, by a pair: the root of its right matches times the share of "
    "them that are right within 1 px.",
    "inlier": "A match that agrees with the geometry that was estimated from all matches of a "
    "pair.",
    "pareto front": "The combinations of which none is better in both of two criteria, such as "
    "speed and quality.",
    "precision": "Inliers / matches, the inlier ratio.",
    "repeatability": "Share of the keypoints that both images show which are found in both.",
    "right match": "A match within 3 px of the reference of its pair.",
    "sharpness": "Matches right within 1 px / within 3 px: it decides how exact a model becomes.",
    "success rate": "Share of the measured pairs with the status ok.",
    "track": "One 3D point with all the images in which it was seen.",
}
"""A sentence each."""
