"""Named presets: parameters of the methods that differ from the tables, and the protocol."""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import dataclass, field

from aerocues.errors import SelectionError
from aerocues.methods.parameters import Value

Overrides = Mapping[str, Mapping[str, Value]]


@dataclass(frozen=True)
class Preset:
    """One preset.

    Parameters
    ----------
    name, title : str
    chance_test : bool
        Whether a model must be better than those that shuffled matches give.
    detectors, descriptors : mapping of method to parameters
        What differs from the tables of methods.
    """

    name: str
    title: str
    chance_test: bool
    detectors: Overrides = field(default_factory=dict)
    descriptors: Overrides = field(default_factory=dict)

    def check(self, detectors: Container[str], descriptors: Container[str]) -> None:
        """Raise SelectionError if a method is named that does not exist."""
        for kind, overrides, known in (
            ("detector", self.detectors, detectors),
            ("descriptor", self.descriptors, descriptors),
        ):
            for name in overrides:
                if name not in known:
                    raise SelectionError(
                        f"preset {self.name} sets parameters of the {kind} {name}, which does "
                        "not exist; see 'aerocues methods'"
                    )


PRESETS: tuple[Preset, ...] = (
    Preset("default", "parameters of the thesis; a model must beat chance", chance_test=True),
    Preset("thesis", "parameters and protocol of the thesis", chance_test=False),
)


def preset_named(name: str) -> Preset:
    """The preset called `name`, in any case; SelectionError where there is none."""
    for preset in PRESETS:
        if preset.name == name.lower():
            return preset
    known = ", ".join(preset.name for preset in PRESETS)
    raise SelectionError(f"there is no preset {name!r}; choose one of {known}")
