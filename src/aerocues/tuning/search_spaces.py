"""Search spaces: the parameters of a method, or the inlier threshold of two methods."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from aerocues.errors import SelectionError
from aerocues.methods.combination import Combination
from aerocues.methods.compatibility import why_incompatible
from aerocues.methods.parameters import Value
from aerocues.methods.presets import Preset
from aerocues.methods.registry import Methods
from aerocues.tuning.grids import GRIDS, THRESHOLDS, Grid, Setting, settings_of

Kind = Literal["detector", "descriptor", "pair", "threshold"]
MATCHER = "EXACT"
"""Of the matchers that find the nearest neighbours it takes least time."""
THRESHOLD = "threshold"
EVERYTHING = "ALL"


@dataclass(frozen=True)
class SearchSpace:
    """The candidate settings of one search.

    Parameters
    ----------
    kind : {"detector", "descriptor", "pair", "threshold"}
        ``pair`` is a descriptor on the keypoints of one detector.
    combination : Combination
        In which the candidates are evaluated.
    settings : tuple of mapping
        The values of each candidate that differ from the default; the first is the default.
    """

    kind: Kind
    combination: Combination
    settings: tuple[Setting, ...]

    @property
    def name(self) -> str:
        """Such as ``detector ORB``, ``descriptor LATCH`` or ``BEBLID on ORB``."""
        detector, descriptor = self.combination.detector, self.combination.descriptor
        return {
            "detector": f"detector {detector}",
            "descriptor": f"descriptor {descriptor}",
            "pair": f"{descriptor} on {detector}",
            "threshold": f"threshold of {detector}-{descriptor}",
        }[self.kind]

    def clashes(self, other: SearchSpace) -> bool:
        """Whether a preset would combine both results into a setting that was never measured."""
        kinds = {self.kind, other.kind}
        same_method = self.name == other.name or (
            kinds == {"descriptor", "pair"}
            and self.combination.descriptor == other.combination.descriptor
        )
        return same_method and not self._parameters().isdisjoint(other._parameters())

    def _parameters(self) -> set[str]:
        return {name for setting in self.settings for name in setting}

    def variant(self, number: int) -> Combination:
        """The name under which candidate `number` is measured; the default keeps its own."""
        if not number:
            return self.combination
        own, found = f"_V{number}", self.combination
        if self.kind == "detector":
            coupled = found.descriptor == found.detector
            return replace(
                found,
                detector=found.detector + own,
                descriptor=found.descriptor + own if coupled else found.descriptor,
            )
        mark = {"descriptor": "_V", "pair": f"_ON_{found.detector}_V", "threshold": "_T"}[self.kind]
        return replace(found, descriptor=f"{found.descriptor}{mark}{number}")

    def added(self, methods: Methods) -> Methods:
        """The methods, with the variants of this space added."""
        detectors, descriptors = dict(methods.detectors), dict(methods.descriptors)
        for number, setting in enumerate(self.settings[1:], start=1):
            named = self.variant(number)
            if self.kind == "detector":
                row = methods.detectors[self.combination.detector]
                parameters = {**row.parameters, **setting}
                detectors[named.detector] = replace(row, name=named.detector, parameters=parameters)
            if named.descriptor != self.combination.descriptor:
                own = methods.descriptor_on(self.combination.descriptor, self.combination.detector)
                changed = {k: v for k, v in setting.items() if k in own.parameters}
                descriptors[named.descriptor] = replace(
                    own, name=named.descriptor, parameters={**own.parameters, **changed}
                )
        return replace(methods, detectors=detectors, descriptors=descriptors)

    def thresholds(self) -> dict[str, float]:
        """Inlier thresholds of the candidates, by "DETECTOR-DESCRIPTOR"."""
        if self.kind != "threshold":
            return {}
        return {
            f"{named.detector}-{named.descriptor}": float(setting[THRESHOLD])
            for number, setting in enumerate(self.settings[1:], start=1)
            if (named := self.variant(number))
        }

    def applied(self, preset: Preset, setting: Setting, methods: Methods) -> Preset:
        """The preset, extended by a setting of this space."""
        detector, descriptor = self.combination.detector, self.combination.descriptor
        both = f"{detector}-{descriptor}"
        if self.kind == "threshold":
            value = float(setting[THRESHOLD])
            return replace(preset, thresholds={**preset.thresholds, both: value})
        if self.kind == "descriptor":
            return replace(preset, descriptors=_with(preset.descriptors, descriptor, setting))
        if self.kind == "pair":
            return replace(preset, on_detectors=_with(preset.on_detectors, both, setting))
        changed = replace(preset, detectors=_with(preset.detectors, detector, setting))
        coupled = {
            name: value
            for name, value in setting.items()
            if detector == descriptor and name in methods.descriptors[descriptor].parameters
        }
        if not coupled:
            return changed
        return replace(changed, on_detectors=_with(changed.on_detectors, both, coupled))


def _with(
    group: Mapping[str, Mapping[str, Value]], name: str, setting: Setting
) -> dict[str, Mapping[str, Value]]:
    return {**group, name: {**group.get(name, {}), **setting}}


def search_spaces_named(
    names: Sequence[str], methods: Methods, grid: Mapping[str, tuple[Value, ...]] | None = None
) -> list[SearchSpace]:
    """The search spaces of several names, each once; see `search_spaces_of`.

    Raises
    ------
    SelectionError
        If there are none, or two searches would set the same parameters.
    """
    found: list[SearchSpace] = []
    for each in (space for name in names for space in search_spaces_of(name, methods, grid)):
        if each in found:
            continue
        for other in found:
            if other.clashes(each):
                raise SelectionError(
                    f"{other.name} in {other.combination} and {each.name} in {each.combination} "
                    "would set the same parameters; tune them one at a time, each into a preset "
                    "of its own"
                )
        found.append(each)
    if not found:
        raise SelectionError(
            "no method is named; give LATCH, ORB-BEBLID-HAM-BF or 'all', for example"
        )
    return found


def search_spaces_of(
    text: str, methods: Methods, grid: Mapping[str, tuple[Value, ...]] | None = None
) -> list[SearchSpace]:
    """The search spaces of a name.

    Parameters
    ----------
    text : str
        A method (``LATCH``; a name that a detector and a descriptor share means both, and
        ``detector:ORB`` or ``descriptor:ORB`` one of them), ``all``, or a combination: its
        detector, its descriptor on the detector's keypoints, and its inlier threshold.
    methods : Methods
    grid : mapping, optional
        Values to try in place of the built-in ones; for one detector or descriptor.

    Raises
    ------
    SelectionError
        If there is no such method, or no grid for it.
    """
    wanted = text.strip().upper()
    if grid is not None and ("-" in wanted or wanted.rpartition(":")[2] == EVERYTHING):
        raise SelectionError(
            f"`grid` holds values for one method, and {text.strip()} is several; name a detector "
            "or a descriptor, such as detector:ORB"
        )
    if "-" in wanted:
        found = _of_combination(Combination.parse(wanted), methods)
    elif grid is not None:
        found = [_own_grid(wanted, methods, grid)]
    else:
        found = [each for row in _rows(wanted) for each in _of_grid(row, methods)]
    if not found:
        raise SelectionError(f"nothing is known to try for {text}; give values as `grid`")
    return found


def _rows(wanted: str) -> list[Grid]:
    kind, colon, name = wanted.rpartition(":")
    rows = [
        row
        for row in GRIDS
        if name in (row.method, EVERYTHING) and (not colon or row.kind == kind.lower())
    ]
    if not rows:
        known = ", ".join(dict.fromkeys(row.method for row in GRIDS))
        raise SelectionError(
            f"nothing is known to try for {wanted}; there are grids for {known}, and 'all'; for "
            "other methods give values as `grid`"
        )
    return rows


def _of_grid(row: Grid, methods: Methods) -> list[SearchSpace]:
    if row.kind == "detector":
        default = methods.detectors[row.method].parameters
        combination = _judged(row.method, row.partner, methods)
        return [SearchSpace("detector", combination, tuple(settings_of(row.values, default)))]
    default = methods.descriptors[row.method].parameters
    combination = _judged(row.partner, row.method, methods)
    found = [SearchSpace("descriptor", combination, tuple(settings_of(row.values, default)))]
    if row.on_each_detector:
        settings = tuple(settings_of(row.on_each_detector, default))
        found += [
            SearchSpace("pair", own, settings)
            for detector, known in methods.detectors.items()
            if not known.on_request
            and why_incompatible(own := _judged(detector, row.method, methods), methods) is None
        ]
    return found


def _judged(detector: str, descriptor: str, methods: Methods) -> Combination:
    norm = "HAM" if methods.descriptors[descriptor].dtype == "uint8" else "L2"
    return Combination(detector, descriptor, norm, MATCHER)


def _own_grid(wanted: str, methods: Methods, grid: Mapping[str, tuple[Value, ...]]) -> SearchSpace:
    kind, _, name = wanted.rpartition(":")
    if kind in ("", "DETECTOR") and name in methods.detectors:
        row = next((g for g in GRIDS if (g.kind, g.method) == ("detector", name)), None)
        combination = _judged(name, row.partner if row else "BRISK", methods)
        _check(grid, methods.detectors[name].parameters, name)
        settings = settings_of(grid, methods.detectors[name].parameters)
        return SearchSpace("detector", combination, tuple(settings))
    if kind in ("", "DESCRIPTOR") and name in methods.descriptors:
        row = next((g for g in GRIDS if (g.kind, g.method) == ("descriptor", name)), None)
        combination = _judged(row.partner if row else "ORB", name, methods)
        _check(grid, methods.descriptors[name].parameters, name)
        settings = settings_of(grid, methods.descriptors[name].parameters)
        return SearchSpace("descriptor", combination, tuple(settings))
    raise SelectionError(f"there is no method {wanted}; see 'aerocues methods'")


def _check(names: Mapping[str, object], known: Mapping[str, object], method: str) -> None:
    for name in names:
        if name not in known:
            raise SelectionError(
                f"{method} has no parameter {name}; it has {', '.join(known) or 'none'}"
            )


def _of_combination(combination: Combination, methods: Methods) -> list[SearchSpace]:
    methods.require(combination)
    reason = why_incompatible(combination, methods)
    if reason is not None:
        raise SelectionError(f"{combination} cannot run: {reason}")
    found = []
    for row in GRIDS:
        if (row.kind, row.method) == ("detector", combination.detector):
            default = methods.detectors[row.method].parameters
            found.append(
                SearchSpace("detector", combination, tuple(settings_of(row.values, default)))
            )
        if (row.kind, row.method) == ("descriptor", combination.descriptor):
            default = methods.descriptors[row.method].parameters
            values = {**row.values, **row.on_each_detector}
            found.append(SearchSpace("pair", combination, tuple(settings_of(values, default))))
    verification = 3.0
    others: Sequence[Setting] = [{THRESHOLD: t} for t in THRESHOLDS if t != verification]
    return [*found, SearchSpace("threshold", combination, ({}, *others))]
