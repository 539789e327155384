"""Where the weights of the networks are."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path

from aerocues.errors import MethodUnavailableError
from aerocues.methods.declarations import why_no_file

FOLDER = Path(__file__).resolve().parent / "weights"
CHECKSUMS = FOLDER / "SHA256SUMS"
VARIABLE = "AEROCUES_LIGHTGLUE_WEIGHTS"
"""The environment variable that names the file of LIGHTGLUE's weights."""
LIGHTGLUE = "lightglue-aliked.onnx"
NEEDED: Mapping[str, str] = {
    "path": str(FOLDER / LIGHTGLUE),
    "variable": VARIABLE,
    "remedy": (
        f"its weights (46 MB) are not part of the package: make {LIGHTGLUE} with `make "
        f"learned-weights` in a checkout of aerocues, and name the file in the environment "
        f"variable {VARIABLE}"
    ),
}
"""The file of LIGHTGLUE's weights, as aerocues looks for it before anything is measured."""


def checksums() -> Mapping[str, str]:
    """The SHA-256 of each file of weights, also of the one that is not part of the package."""
    lines = CHECKSUMS.read_text(encoding="ascii").splitlines()
    return {name: digest for digest, name in (line.split() for line in lines)}


def sha256(file: Path) -> str:
    """The SHA-256 of a file."""
    with file.open("rb") as opened:
        return hashlib.file_digest(opened, "sha256").hexdigest()


def lightglue_weights() -> Path:
    """The weights of LIGHTGLUE: the file that `VARIABLE` names, or the one in the package.

    Raises
    ------
    MethodUnavailableError
        If there is no such file, or it holds something else.
    """
    if missing := why_no_file(NEEDED):
        raise MethodUnavailableError(f"LIGHTGLUE cannot run: {missing}")
    file = Path(os.environ.get(VARIABLE) or NEEDED["path"]).expanduser()
    if sha256(file) != checksums()[LIGHTGLUE]:
        raise MethodUnavailableError(
            f"LIGHTGLUE cannot run: {file} is another file than this version of aerocues-learned "
            f"was tested with; make {LIGHTGLUE} again with `make learned-weights`"
        )
    return file
