"""ALIKED as one graph: network, keypoints and descriptors."""

from __future__ import annotations

from typing import Any

import torch
import torch.nn.functional as functional
from kornia.feature.aliked.aliked import ALIKED, DeformableConv2d
from kornia.feature.aliked.deform_conv2d import deform_conv2d
from torch import Tensor, nn
from torch.onnx import symbolic_helper

OPSET = 19
"""The first one with an operator for deformable convolution."""
RADIUS = 2
"""Pixels around a keypoint without a stronger one; nearer to the border there is none."""
TEMPERATURE = 0.1
PATCH = 3


class AlikedGraph(nn.Module):
    """From an RGB image (0 to 1), with sides that are multiples of 32, to features.

    ``crop`` is left, top, width and height of what is not padding; positions (N, 2) are pixels of
    that part. Scores (N,) are those of the best pixel, descriptors (N, D) have unit length; the
    strongest are first.
    """

    def __init__(self, name: str, weights: dict[str, Tensor]) -> None:
        super().__init__()
        self.network = ALIKED(name)
        self.network.load_state_dict(weights, strict=False)
        _make_exportable(self.network)
        self.eval()

    def forward(
        self, image: Tensor, crop: Tensor, count: Tensor, threshold: Tensor
    ) -> tuple[Tensor, Tensor, Tensor]:
        features = self._dense(image)
        score = torch.sigmoid(self.network.score_head(features))
        left, top, width, height = crop.unbind()
        rows, columns = slice(top, top + height), slice(left, left + width)
        score = score[0, 0, rows, columns]
        features = functional.normalize(features, dim=1)[0, :, rows, columns]
        xy, best = _keypoints(score, count, threshold)
        return xy, best, self._described(features, xy)

    def _dense(self, image: Tensor) -> Tensor:
        """The map of features, before it is normalised."""
        network = self.network
        x1 = network.block1(image)
        x2 = network.block2(network.pool2(x1))
        x3 = network.block3(network.pool4(x2))
        x4 = network.block4(network.pool4(x3))
        maps = [
            network.gate(network.conv1(x1)),
            network.upsample2(network.gate(network.conv2(x2))),
            network.upsample8(network.gate(network.conv3(x3))),
            network.upsample32(network.gate(network.conv4(x4))),
        ]
        return torch.cat(maps, 1)

    def _described(self, features: Tensor, xy: Tensor) -> Tensor:
        """Descriptors of points: learned positions around each are sampled and added up."""
        head = self.network.desc_head
        channels, height, width = features.shape
        offset = head.offset_conv(_patches(features, xy))[:, :, 0, 0]
        longest = torch.maximum(torch.as_tensor(height), torch.as_tensor(width)) / 4
        offset = torch.maximum(torch.minimum(offset, longest), -longest)
        places = xy[:, None] + offset.reshape(-1, 2, head.n_pos).permute(0, 2, 1)
        last = torch.stack([torch.as_tensor(width - 1), torch.as_tensor(height - 1)]).float()
        grid = (2 * places / last - 1).reshape(1, -1, 1, 2)
        sampled = functional.grid_sample(features[None], grid, align_corners=True)
        sampled = sampled.reshape(channels, -1, head.n_pos, 1).permute(1, 0, 2, 3)
        seen = functional.selu(head.sf_conv(sampled)).squeeze(-1).permute(0, 2, 1)
        described = seen.flatten(1) @ head.agg_weights.reshape(-1, channels)
        return functional.normalize(described, dim=1)


def _keypoints(score: Tensor, count: Tensor, threshold: Tensor) -> tuple[Tensor, Tensor]:
    """The strongest maxima of a (H, W) map, between pixels, and the scores at these pixels."""
    height, width = score.shape
    strongest = functional.max_pool2d(score[None, None], 2 * RADIUS + 1, 1, RADIUS)[0, 0]
    rows, columns = torch.arange(height)[:, None], torch.arange(width)[None]
    inside = (rows >= RADIUS) & (rows < height - RADIUS)
    inside = inside & (columns >= RADIUS) & (columns < width - RADIUS)
    inside = inside & (score == strongest) & (score > threshold)
    flat = score.reshape(-1)
    found = torch.nonzero(inside.reshape(-1))[:, 0]
    best, order = torch.topk(flat[found], torch.minimum(count, torch.as_tensor(found.shape[0])))
    found = found[order]
    steps = torch.arange(-RADIUS, RADIUS + 1)
    places = found[:, None] + (steps[:, None] * width + steps[None]).reshape(-1)[None]
    weight = functional.softmax(flat[places] / TEMPERATURE, dim=1)
    side = 2 * RADIUS + 1
    x, y = steps.float().repeat(side), steps.float().repeat_interleave(side)
    between = torch.stack([(weight * x).sum(1), (weight * y).sum(1)], 1)
    return torch.stack([found % width, found // width], 1).float() + between, best


def _patches(features: Tensor, xy: Tensor) -> Tensor:
    """(N, C, 3, 3) values around the pixels of points, shifted into the map at its border."""
    channels, height, width = features.shape
    first = ((xy.long() - PATCH / 2) + 1).long()
    column = first[:, 0].clamp(min=0).minimum(torch.as_tensor(width - 1 - PATCH))
    row = first[:, 1].clamp(min=0).minimum(torch.as_tensor(height - 1 - PATCH))
    steps = torch.arange(PATCH)
    around = (steps[:, None] * width + steps[None]).reshape(-1)
    places = (row * width + column)[:, None] + around[None]
    values = features.reshape(channels, -1)[:, places.reshape(-1)]
    return values.reshape(channels, -1, PATCH, PATCH).permute(1, 0, 2, 3)


class _Deformable(nn.Module):
    """A deformable convolution whose limit of offsets follows the size of the image."""

    def __init__(self, original: DeformableConv2d) -> None:
        super().__init__()
        self.original = original

    def forward(self, x: Tensor) -> Tensor:
        own = self.original
        height, width = x.shape[2:]
        longest = torch.maximum(torch.as_tensor(height), torch.as_tensor(width)) / 4
        offset = torch.maximum(torch.minimum(own.offset_conv(x), longest), -longest)
        weight, bias = own.regular_conv.weight, own.regular_conv.bias
        result = torch.ops.aerocues.deform_conv(x, offset, weight, own.padding)
        return result if bias is None else result + bias.view(1, -1, 1, 1)


def _make_exportable(network: nn.Module) -> None:
    for module in network.modules():
        if hasattr(module, "inplace"):
            # Exported, an activation in place would change what a skip connection needs.
            module.inplace = False
    for parent in list(network.modules()):
        for name, child in list(parent.named_children()):
            if isinstance(child, DeformableConv2d):
                setattr(parent, name, _Deformable(child))


def register_operator() -> None:
    """Make deformable convolution one operator, for which ONNX has one, too."""
    library = torch.library.Library("aerocues", "DEF")
    library.define("deform_conv(Tensor x, Tensor offset, Tensor weight, int padding) -> Tensor")
    library.impl("deform_conv", _deform_conv, "CPU")
    torch.onnx.register_custom_op_symbolic("aerocues::deform_conv", _deform_conv_in_onnx, OPSET)
    _LIBRARIES.append(library)


_LIBRARIES: list[Any] = []
"""Operators exist as long as the library that defines them."""


def _deform_conv(x: Tensor, offset: Tensor, weight: Tensor, padding: int) -> Tensor:
    return deform_conv2d(x, offset, weight, None, padding=padding)


def _deform_conv_in_onnx(graph: Any, x: Any, offset: Any, weight: Any, padding: Any) -> Any:
    around = symbolic_helper._parse_arg(padding, "i")
    return graph.op(
        "DeformConv",
        x,
        weight,
        offset,
        kernel_shape_i=[3, 3],
        pads_i=[around] * 4,
        strides_i=[1, 1],
        dilations_i=[1, 1],
        group_i=1,
        offset_group_i=1,
    )
