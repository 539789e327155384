"""LightGlue as one graph, without early stopping and pruning: all layers see all keypoints."""

from __future__ import annotations

import torch
from kornia.feature.lightglue import LightGlue
from torch import Tensor, nn


class LightGlueGraph(nn.Module):
    """From normalised positions (1, N, 2) and descriptors (1, N, D) of two images to matches.

    Outputs are, for each keypoint, the best of the other image, (M,) and (N,), and the confidence
    (M,) of the best of those of the first image.
    """

    def __init__(self, weights: dict[str, Tensor], **configuration: int) -> None:
        super().__init__()
        self.network = LightGlue(
            None,
            **configuration,
            flash=False,
            depth_confidence=-1,
            width_confidence=-1,
        )
        missing = self.network.load_state_dict(_renamed(weights), strict=False).missing_keys
        if set(missing) - {"confidence_thresholds"}:
            raise ValueError(f"the file of weights lacks {missing[:5]}")
        self.eval()

    def forward(
        self, keypoints_1: Tensor, descriptors_1: Tensor, keypoints_2: Tensor, descriptors_2: Tensor
    ) -> tuple[Tensor, Tensor, Tensor]:
        network = self.network
        first, second = network.input_proj(descriptors_1), network.input_proj(descriptors_2)
        place_1, place_2 = network.posenc(keypoints_1), network.posenc(keypoints_2)
        for layer in network.transformers:
            first, second = layer(first, second, place_1, place_2)
        assignment, _ = network.log_assignment[-1](first, second)
        # The last row and column stand for no match.
        inner = assignment[0, :-1, :-1]
        best = inner.max(1)
        return best.indices, inner.max(0).indices, best.values.exp()


def _renamed(weights: dict[str, Tensor]) -> dict[str, Tensor]:
    """Weights under the names of kornia's network; the files have older ones."""
    renamed = {}
    for name, value in weights.items():
        new = name.removeprefix("matcher.")
        for kind in ("self_attn", "cross_attn"):
            if new.startswith(f"{kind}."):
                _, layer, rest = new.split(".", 2)
                new = f"transformers.{layer}.{kind}.{rest}"
        renamed[new] = value
    return renamed


def example(columns: int) -> tuple[Tensor, ...]:
    """Inputs of the shapes that the graph is traced with."""
    torch.manual_seed(0)
    inputs = []
    for count in (300, 310):
        descriptors = torch.nn.functional.normalize(torch.randn(1, count, columns), dim=-1)
        inputs += [torch.rand(1, count, 2), descriptors]
    return tuple(inputs)
