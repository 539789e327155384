"""All methods that can be combined: OpenCV's and those that plug-ins bring."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

from aerocues.errors import SelectionError
from aerocues.methods.combination import NONE, Combination
from aerocues.methods.descriptors import DESCRIPTORS, DescriptorRow
from aerocues.methods.detectors import DETECTORS, DetectorRow
from aerocues.methods.exact.availability import why_not_exact
from aerocues.methods.extra import EXTRA_DESCRIPTORS, EXTRA_DETECTORS, EXTRA_MATCHERS
from aerocues.methods.matchers import EXACT, MATCHERS, NORMS, MatcherRow, NormRow
from aerocues.methods.motion_statistics import why_not_gms
from aerocues.methods.pair_matchers import NO_DESCRIPTOR, NO_NORM, PIXELMAP, positions_of
from aerocues.methods.parameters import OPENCV, why_missing
from aerocues.methods.pixelmap import why_not_pixelmap
from aerocues.methods.presets import Overrides, Preset


@dataclass(frozen=True)
class Methods:
    """The methods by name, in the order of the tables.

    ``on_detectors`` has what differs for a descriptor on the keypoints of one detector, by
    "DETECTOR-DESCRIPTOR". ``problems`` tells of plug-ins that are left out, one sentence each.

    Pair matchers are among the matchers. Among the detectors stands a row for the positions that
    each of them finds, and among the descriptors and norms the row NONE, which they do without.
    """

    detectors: Mapping[str, DetectorRow]
    descriptors: Mapping[str, DescriptorRow]
    norms: Mapping[str, NormRow]
    matchers: Mapping[str, MatcherRow]
    problems: tuple[str, ...] = ()
    on_detectors: Overrides = field(default_factory=dict)

    @property
    def pair_matchers(self) -> list[str]:
        """Names of the pair matchers."""
        return [name for name, row in self.matchers.items() if row.of_pairs]

    @property
    def sets(self) -> list[str]:
        """Names of the sets of methods that take part on request."""
        tables: tuple[Mapping[str, Any], ...] = (self.detectors, self.descriptors, self.matchers)
        named = (row.on_request for table in tables for row in table.values())
        return list(dict.fromkeys(filter(None, named)))

    def rows(self, combination: Combination) -> tuple[DetectorRow, DescriptorRow, MatcherRow]:
        """The rows of the three methods of a combination."""
        return (
            self.detectors[combination.detector],
            self.descriptors[combination.descriptor],
            self.matchers[combination.matcher],
        )

    def with_pair_matcher(self, row: MatcherRow) -> Methods:
        """The same methods and a pair matcher."""
        return replace(
            self,
            detectors={**self.detectors, row.name: positions_of(row)},
            descriptors={**self.descriptors, NONE: NO_DESCRIPTOR},
            norms={**self.norms, NONE: NO_NORM},
            matchers={**self.matchers, row.name: row},
        )

    def parse(self, text: str) -> Combination:
        """Read the text form of a combination, or the name of a pair matcher alone.

        Raises
        ------
        SelectionError
            If it is neither.
        """
        name = text.strip().upper()
        if name in self.pair_matchers:
            return Combination.of_pair_matcher(name)
        return Combination.parse(text)

    def descriptor_on(self, descriptor: str, detector: str) -> DescriptorRow:
        """The row of a descriptor as it describes the keypoints of a detector."""
        row = self.descriptors[descriptor]
        own = self.on_detectors.get(f"{detector}-{descriptor}")
        return replace(row, parameters={**row.parameters, **own}) if own else row

    def combinations(self, *, on_request: bool = False) -> Iterator[Combination]:
        """Every combination that can be written down, runnable or not.

        Those of methods on request are left out without `on_request`, as are keypoints that a pair
        matcher guides.
        """

        def taken(rows: Mapping[str, Any]) -> list[str]:
            return [name for name, row in rows.items() if on_request or not row.on_request]

        pairs = [name for name in taken(self.matchers) if name in self.pair_matchers]
        apart = {*self.pair_matchers, NONE}
        tables = (taken(self.detectors), taken(self.descriptors), self.norms, taken(self.matchers))
        own = [[name for name in table if name not in apart] for table in tables]
        for names in product(*own):
            yield Combination(*names)
        yield from map(Combination.of_pair_matcher, pairs)
        if on_request:
            for detector, matcher in product(own[0], pairs):
                yield Combination(detector, NONE, NONE, matcher)

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
            ("matcher", combination.matcher, self.matchers),
        ):
            if name not in known:
                raise SelectionError(f"there is no {kind} {name}; known are {', '.join(known)}")

    def parameters(self, combination: Combination) -> dict[str, object]:
        """Everything that decides what the methods of `combination` compute."""
        detector = self.detectors[combination.detector]
        descriptor = self.descriptor_on(combination.descriptor, combination.detector)
        matcher = self.matchers[combination.matcher]
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
    """OpenCV's 14 detectors, 14 descriptors, 2 norms and 2 matchers; others on request.

    What this build of OpenCV lacks, as those without the contributed modules do, is unavailable.
    """
    detectors, descriptors = (*DETECTORS, *EXTRA_DETECTORS), (*DESCRIPTORS, *EXTRA_DESCRIPTORS)
    missing = {EXACT.name: why_not_exact(), "GMS": why_not_gms()}
    matchers = (*MATCHERS, EXACT, *EXTRA_MATCHERS)
    methods = Methods(
        {row.name: replace(row, unavailable=why_missing(row.factory)) for row in detectors},
        {row.name: replace(row, unavailable=why_missing(row.factory)) for row in descriptors},
        {row.name: row for row in NORMS},
        {row.name: replace(row, unavailable=missing.get(row.name)) for row in matchers},
    )
    return methods.with_pair_matcher(replace(PIXELMAP, unavailable=why_not_pixelmap()))
