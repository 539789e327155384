"""All methods that can be combined: OpenCV's and those that plug-ins bring."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import product

from aerocues.errors import SelectionError
from aerocues.methods.combination import Combination
from aerocues.methods.descriptors import DESCRIPTORS, DescriptorRow
from aerocues.methods.detectors import DETECTORS, DetectorRow
from aerocues.methods.exact.availability import why_not_exact
from aerocues.methods.matchers import EXACT, MATCHERS, NORMS, MatcherRow, NormRow
from aerocues.methods.parameters import OPENCV, why_missing
from aerocues.methods.presets import Overrides, Preset


@dataclass(frozen=True)
class Methods:
    """The methods by name, in the order of the tables.

    ``on_detectors`` has what differs for a descriptor on the keypoints of one detector, by
    "DETECTOR-DESCRIPTOR". ``problems`` tells of plug-ins that are left out, one sentence each.
    Matchers in ``on_request`` take part only where they are named: nothing else includes them.
    """

    detectors: Mapping[str, DetectorRow]
    descriptors: Mapping[str, DescriptorRow]
    norms: Mapping[str, NormRow]
    matchers: Mapping[str, MatcherRow]
    problems: tuple[str, ...] = ()
    on_detectors: Overrides = field(default_factory=dict)
    on_request: Mapping[str, MatcherRow] = field(default_factory=dict)

    @property
    def every_matcher(self) -> Mapping[str, MatcherRow]:
        """The matchers by name, and those on request."""
        return {**self.matchers, **self.on_request}

    def descriptor_on(self, descriptor: str, detector: str) -> DescriptorRow:
        """The row of a descriptor as it describes the keypoints of a detector."""
        row = self.descriptors[descriptor]
        own = self.on_detectors.get(f"{detector}-{descriptor}")
        return replace(row, parameters={**row.parameters, **own}) if own else row

    def combinations(self, *, on_request: bool = False) -> Iterator[Combination]:
        """Every combination that can be written down, runnable or not.

        Those of matchers on request are left out without `on_request`.
        """
        matchers = self.every_matcher if on_request else self.matchers
        for names in product(self.detectors, self.descriptors, self.norms, matchers):
            yield Combination(*names)

    def require(self, combination: Combination) -> None:
        """Check that the four names exist.

        Raises
        ------
        SelectionError
            Naming the first one that does not.
        """
        for kind, name, known in (
            ("detector", combination.detector, self.detectors),
            ("descriptor", combination.descriptor, self.descriptors),
            ("norm", combination.norm, self.norms),
            ("matcher", combination.matcher, self.every_matcher),
        ):
            if name not in known:
                raise SelectionError(f"there is no {kind} {name}; known are {', '.join(known)}")

    def parameters(self, combination: Combination) -> dict[str, object]:
        """Everything that decides what the methods of `combination` compute."""
        detector = self.detectors[combination.detector]
        descriptor = self.descriptor_on(combination.descriptor, combination.detector)
        matcher = self.every_matcher[combination.matcher]
        return {
            "detector": [detector.origin, detector.factory, dict(detector.parameters)],
            "descriptor": [descriptor.origin, descriptor.factory, dict(descriptor.parameters)],
            "matcher": [
                matcher.origin,
                matcher.name if matcher.origin == OPENCV else matcher.factory,
                dict(matcher.parameters.get(combination.norm, {})),
            ],
            "norm": combination.norm,
        }

    def with_preset(self, preset: Preset) -> Methods:
        """The same methods with the parameters that `preset` changes."""
        preset.check(self.detectors, self.descriptors)
        return replace(
            self,
            detectors={
                name: replace(
                    row, parameters=preset.parameters_of(row, preset.detectors.get(name, {}))
                )
                for name, row in self.detectors.items()
            },
            descriptors={
                name: replace(
                    row, parameters=preset.parameters_of(row, preset.descriptors.get(name, {}))
                )
                for name, row in self.descriptors.items()
            },
            on_detectors={**self.on_detectors, **preset.on_detectors},
        )


def opencv_methods() -> Methods:
    """OpenCV's 14 detectors, 14 descriptors, 2 norms and 2 matchers; EXACT on request.

    What this build of OpenCV lacks, as those without the contributed modules do, is unavailable.
    """
    return Methods(
        {row.name: replace(row, unavailable=why_missing(row.factory)) for row in DETECTORS},
        {row.name: replace(row, unavailable=why_missing(row.factory)) for row in DESCRIPTORS},
        {row.name: row for row in NORMS},
        {row.name: row for row in MATCHERS},
        on_request={EXACT.name: replace(EXACT, unavailable=why_not_exact())},
    )
