"""Where the weights of the networks are."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path

from aerocues.errors import MethodUnavailableError

FOLDER = Path(__file__).resolve().parent / "weights"
CHECKSUMS = FOLDER / "SHA256SUMS"
VARIABLE = "AEROCUES_LIGHTGLUE_WEIGHTS"
"""The environment variable that names the file of LIGHTGLUE's weights."""
LIGHTGLUE = "lightglue-aliked.onnx"


def checksums() -> Mapping[str, str]:
    """The SHA-256 of each file of weights, also of the one that is not part of the package."""
    lines = CHECKSUMS.read_text(encoding="ascii").splitlines()
    return {name: digest for digest, name in (line.split() for line in lines)}


def sha256(file: Path) -> str:
    """The SHA-256 of a file."""
    with file.open("rb") as opened:
        return hashlib.file_digest(opened, "sha256").hexdigest()


def lightglue_weights(path: str = "") -> Path:
    """The weights of LIGHTGLUE, which are too large for the package (46 MB).

    Parameters
    ----------
    path : str
        The file; empty: the one that `VARIABLE` names, or the one in the folder of the package.

    Raises
    ------
    MethodUnavailableError
        If there is no such file, or it holds something else.
    """
    named = path or os.environ.get(VARIABLE, "")
    file = Path(named).expanduser() if named else FOLDER / LIGHTGLUE
    if not file.is_file():
        where = f"{file} does not exist" if named else "its weights (46 MB) are not in the package"
        raise MethodUnavailableError(
            f"LIGHTGLUE cannot run: {where}; make {LIGHTGLUE} with `make learned-weights` in a "
            f"checkout of aerocues, and name the file in the environment variable {VARIABLE}"
        )
    if sha256(file) != checksums()[LIGHTGLUE]:
        raise MethodUnavailableError(
            f"LIGHTGLUE cannot run: {file} is another file than this version of aerocues-learned "
            f"was tested with; make {LIGHTGLUE} again with `make learned-weights`"
        )
    return file
