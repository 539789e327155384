"""Named presets: parameters of the methods that differ from the tables, and the protocol."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from aerocues.errors import SelectionError
from aerocues.methods.parameters import Value

Overrides = Mapping[str, Mapping[str, Value]]


class Tunable(Protocol):
    """A row of a table of methods."""

    @property
    def parameters(self) -> Mapping[str, Value]:
        """By name, with the values of the table."""

    @property
    def unbiased(self) -> Mapping[str, Value]:
        """Those besides that put keypoints where they really are."""


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
    on_detectors : mapping of "DETECTOR-DESCRIPTOR" to parameters
        What differs for a descriptor on the keypoints of one detector: the sizes of keypoints
        mean different things.
    thresholds : mapping of "DETECTOR-DESCRIPTOR" to float
        Inlier thresholds in pixels that differ from the protocol's.
    unbiased : bool
        Whether keypoints are put where they really are, where OpenCV shifts them.
    """

    name: str
    title: str
    chance_test: bool
    detectors: Overrides = field(default_factory=dict)
    descriptors: Overrides = field(default_factory=dict)
    on_detectors: Overrides = field(default_factory=dict)
    thresholds: Mapping[str, float] = field(default_factory=dict)
    unbiased: bool = True

    def parameters_of(self, row: Tunable, changed: Mapping[str, Value]) -> dict[str, Value]:
        """The parameters of a method: those of its table, and what this preset changes of them."""
        return {**row.parameters, **(row.unbiased if self.unbiased else {}), **changed}

    def check(self, detectors: Mapping[str, Tunable], descriptors: Mapping[str, Tunable]) -> None:
        """Raise SelectionError if a method or a parameter is named that does not exist."""
        for name, parameters in self.detectors.items():
            self._check("detector", name, detectors, parameters)
        for name, parameters in self.descriptors.items():
            self._check("descriptor", name, descriptors, parameters)
        for both, parameters in (*self.on_detectors.items(), *((t, {}) for t in self.thresholds)):
            detector, _, descriptor = both.partition("-")
            self._check("detector", detector, detectors, {})
            self._check("descriptor", descriptor, descriptors, parameters)

    def _check(
        self, kind: str, name: str, known: Mapping[str, Tunable], parameters: Mapping[str, Value]
    ) -> None:
        if name not in known:
            raise SelectionError(
                f"preset {self.name} sets parameters of the {kind} {name}, which does "
                "not exist; see 'aerocues methods'"
            )
        own = {**known[name].parameters, **known[name].unbiased}
        for parameter in parameters:
            if parameter not in own:
                raise SelectionError(
                    f"preset {self.name}: the {kind} {name} has no parameter {parameter}; it has "
                    f"{', '.join(own) or 'none'}"
                )


METHOD_PRESETS: tuple[Preset, ...] = (
    Preset("default", "parameters of the thesis; a model must beat chance", chance_test=True),
    Preset("thesis", "parameters and protocol of the thesis", chance_test=False, unbiased=False),
)

TUNED = "tuned"
"""The preset that aerocues brings along in a file: see `preset_files.tuned_preset`."""


def preset_names() -> tuple[str, ...]:
    """Names of the presets that aerocues brings along."""
    return (*(preset.name for preset in METHOD_PRESETS), TUNED)


def preset_named(name: str) -> Preset:
    """The preset called `name`, in any case, or of the file of that path.

    Raises
    ------
    SelectionError
        If there is neither, or the file is no preset.
    """
    for preset in METHOD_PRESETS:
        if preset.name == name.lower():
            return preset
    if name.lower() == TUNED:
        from aerocues.methods.preset_files import tuned_preset

        return tuned_preset()
    if Path(name).is_file():
        from aerocues.methods.preset_files import read_preset

        return read_preset(Path(name))
    known = ", ".join(preset_names())
    raise SelectionError(f"there is no preset {name!r}; choose one of {known}, or give a file")


def as_preset(preset: str | Preset) -> Preset:
    """A preset as it is, or by its name or file; see `preset_named`."""
    return preset_named(preset) if isinstance(preset, str) else preset
