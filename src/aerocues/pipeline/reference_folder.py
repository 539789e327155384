"""References on disk, for the other processes of a run and for runs that come later."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from aerocues.datasets.dataset import Image
from aerocues.pipeline.feature_arrays import read_arrays, write_arrays
from aerocues.pipeline.reference import REFERENCE_VERSION, Reference
from aerocues.pipeline.reference_flow import Flow
from aerocues.results.hashing import content_hash

NAMES = ("verdict", "agreement", "before", "steps", "after")


def reference_key(first: Image, second: Image) -> str:
    """The hash of all that decides the reference of two images: pixels and versions.

    Raises
    ------
    ImageError
        If an image cannot be read at all.
    """
    images = [image.source.content_key() for image in (first, second)]
    return content_hash([REFERENCE_VERSION, cv2.__version__, images])


class ReferenceFolder:
    """A file for each reference, written whole: processes that write the same one do no harm.

    ``problem`` says why nothing is kept any more.

    Parameters
    ----------
    folder : path
        Made where it is missing.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.problem: str | None = None

    def reference(self, key: str) -> Reference | None:
        """The reference of a key; None where it is not here, or its file is damaged."""
        found = read_arrays(self._file(key), NAMES)
        if found is None:
            return None
        flow = Flow(found["before"], found["steps"], found["after"])
        agreement = float(found["agreement"])
        return Reference(
            str(found["verdict"]),
            None if np.isnan(agreement) else agreement,
            flow if flow.steps.size else None,
        )

    def keep(self, key: str, reference: Reference) -> None:
        """Write a reference; where there is no room, note it and go on without."""
        if self.problem is not None:
            return
        flow = reference.flow or Flow(np.eye(3), np.empty((0, 0, 2), np.int16), np.eye(3))
        agreement = np.nan if reference.agreement is None else reference.agreement
        arrays = {"verdict": np.array(reference.verdict), "agreement": np.array(agreement)}
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            write_arrays(self._file(key), {**arrays, **vars(flow)}, compressed=True)
        except OSError as error:
            self.problem = f"references are kept no longer in {self._folder}: {error.strerror}"

    def _file(self, key: str) -> Path:
        return self._folder / f"{key}.npz"
