"""Options that limit what a recommended combination may cost."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from collections.abc import Mapping


class Objective(StrEnum):
    """Values of ``--objective``."""

    BALANCED = "balanced"
    EFFICIENCY = "efficiency"
    SPEED = "speed"
    ACCURACY = "accuracy"
    RECONSTRUCTION = "reconstruction"
    ROBUST = "robust"
    CONTROLLED = "controlled"


class Licence(StrEnum):
    """Values of ``--licence``."""

    PERMISSIVE = "permissive"


MaxSecondsOption = Annotated[
    str | None,
    typer.Option(
        "--max-seconds-per-image",
        metavar="TIME",
        help="Only combinations with at most this median time for an image and a pair, "
        "such as 0.2 or 50ms.",
    ),
]
MaxMemoryOption = Annotated[
    str | None,
    typer.Option(
        "--max-memory",
        metavar="SIZE",
        help="Only combinations whose stages need at most this much memory, such as 300MB.",
    ),
]
MaxBytesOption = Annotated[
    float | None,
    typer.Option(
        "--max-descriptor-bytes",
        metavar="BYTES",
        help="Only combinations whose descriptors have at most this many bytes.",
    ),
]
LicenceOption = Annotated[
    Licence | None,
    typer.Option("--licence", help="Only methods whose code has such a licence."),
]


@dataclass(frozen=True)
class Limits:
    """The limits that were given, as `aerocues.choose` takes them."""

    max_seconds_per_image: str | None
    max_memory: str | None
    max_descriptor_bytes: float | None
    licence: Licence | None

    def given(self) -> Mapping[str, Any]:
        """Only those that were given."""
        return {
            name: value.value if isinstance(value, Licence) else value
            for name, value in asdict(self).items()
            if value is not None
        }
