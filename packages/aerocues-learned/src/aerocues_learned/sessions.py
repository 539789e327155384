"""Networks in ONNX Runtime: on one thread, as all methods are timed, the same every time."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aerocues.errors import MethodUnavailableError

CPU = "CPUExecutionProvider"
"""ONNX Runtime's name of the processor: the default of every method here."""
NO_MEMORY = ("Failed to allocate memory", "bad_alloc", "bad allocation", "out of memory")
"""What ONNX Runtime says where memory is missing; it has no error class for that."""


class Network:
    """One graph, loaded, in ONNX Runtime.

    Parameters
    ----------
    graph : Path
    provider : str
        What computes, under ONNX Runtime's name for it, such as ``CUDAExecutionProvider``.

    Raises
    ------
    MethodUnavailableError
        If this installation of ONNX Runtime cannot use `provider`.
    """

    def __init__(self, graph: Path, provider: str = CPU) -> None:
        import onnxruntime

        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = options.inter_op_num_threads = 1
        # Plans of memory are made for one size of input and kept: images and keypoints differ.
        options.enable_mem_pattern = False
        options.use_deterministic_compute = True
        # What goes wrong is raised; only what ends the process is printed, too.
        options.log_severity_level = 4
        known = onnxruntime.get_available_providers()
        if provider not in known:
            raise MethodUnavailableError(_no_provider(provider, known))
        providers = list(dict.fromkeys((provider, CPU)))
        self._session = onnxruntime.InferenceSession(str(graph), options, providers=providers)
        # Where its drivers are missing, a provider is left out with a line on standard error only.
        if provider not in self._session.get_providers():
            raise MethodUnavailableError(_no_provider(provider, self._session.get_providers()))

    def __call__(self, **inputs: NDArray[Any]) -> list[NDArray[Any]]:
        """The outputs of the graph, in its order.

        Raises
        ------
        MemoryError
            If there is not enough memory for inputs of this size.
        """
        arrays: Mapping[str, NDArray[Any]] = {
            name: np.ascontiguousarray(array) for name, array in inputs.items()
        }
        try:
            outputs: list[NDArray[Any]] = self._session.run(None, arrays)
        except Exception as error:
            # Its classes of errors derive from Exception directly and tell nothing of the cause.
            if any(words in str(error) for words in NO_MEMORY):
                raise MemoryError(
                    "not enough memory for the network; use fewer keypoints or smaller images"
                ) from error
            raise
        return outputs


def _no_provider(asked: str, known: list[str]) -> str:
    return (
        f"this ONNX Runtime cannot compute on {asked}; it knows {', '.join(known)}: choose one of "
        "them as parameter 'provider', or install the ONNX Runtime for that device"
    )
