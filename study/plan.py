"""What the study measures: `study.toml` as a plan of steps, and the hours that they take."""

from __future__ import annotations

import importlib.util
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from aerocues.errors import ArgumentError
from aerocues.methods.plugins import installed_methods
from aerocues.methods.presets import Preset, as_preset
from aerocues.methods.selection import select
from aerocues.results.hashing import content_hash

FOLDER = Path(__file__).resolve().parent
CONFIGURATION = FOLDER / "study.toml"
FIXED = ("default", "thesis")
"""Presets whose parameters never change."""
UNFINISHED = 3
"""Exit code where something is left to measure."""


@dataclass(frozen=True)
class Round:
    """Combinations that all parts are measured with before the next round begins.

    Attributes
    ----------
    name : str
    combinations : str
        Patterns, as `aerocues.run` takes them.
    seconds_per_row : float
        CPU seconds, as long as nothing tells better.
    run : mapping of str to object
        Arguments of `aerocues.run` that differ from those of the part.
    """

    name: str
    combinations: str
    seconds_per_row: float
    run: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Part:
    """One dataset under one preset: a folder of the database.

    Attributes
    ----------
    name, title, licence : str
    dataset : str
        As `aerocues.open_dataset` takes it, with ``{data}`` for the folder of real images and
        ``{flights}`` for what the study makes itself.
    pairs : int
        About as many will be measured; only the estimate of hours depends on it.
    rounds : tuple of str
    needs : tuple of str
        Python modules without which the part is skipped.
    factor : float
        How much longer a row takes than the round says.
    open, run, models : mapping of str to object
        Arguments of `aerocues.open_dataset`, of `aerocues.run`, and of `aerocues.reconstruct`
        (empty: no models).
    """

    name: str
    title: str
    licence: str
    dataset: str
    pairs: int
    rounds: tuple[str, ...]
    needs: tuple[str, ...] = ()
    factor: float = 1.0
    open: Mapping[str, Any] = field(default_factory=dict)
    run: Mapping[str, Any] = field(default_factory=dict)
    models: Mapping[str, Any] = field(default_factory=dict)

    @property
    def settings(self) -> dict[str, Any]:
        """Arguments of `aerocues.run`, with the thresholds of the preset: these are studied."""
        return {"equal_footing": False, **self.run}

    @property
    def preset(self) -> Preset:
        """The preset that it is measured under."""
        return as_preset(self.run.get("preset", "default"))


MODELS = "models"
"""The step after all rounds of a part that has models."""


@dataclass(frozen=True)
class Step:
    """One round of one part; without a round, its models."""

    part: Part
    round: Round | None

    @property
    def short_name(self) -> str:
        """The name within its part, such as ``exact``."""
        return self.round.name if self.round else MODELS

    @property
    def name(self) -> str:
        """Such as ``oxford-tuned exact``."""
        return f"{self.part.name} {self.short_name}"

    def asked(self) -> str:
        """A hash of what the configuration asks of it, and of the parameters of its methods.

        The settings of flights and versions of software are not in it: after a change there, remove
        the part from the database and its work folder. ``seconds_per_row`` is in it without need.
        """
        terms = asdict(self.part) | {"round": asdict(self.round) if self.round else None}
        if self.part.preset.name not in FIXED:
            terms["parameters"] = self._parameters()
        if self.round:
            terms["models"] = {}  # other models do not concern its rows
        told = ("title", "licence", "pairs", "rounds", "factor")
        return content_hash({name: value for name, value in terms.items() if name not in told})

    def _parameters(self) -> dict[str, object]:
        """Parameters of its methods, by combination."""
        methods = installed_methods().with_preset(self.part.preset)
        return {str(each): methods.parameters(each) for each in select(methods, self.combinations)}

    @property
    def combinations(self) -> str:
        """The patterns of this step."""
        return self.round.combinations if self.round else str(self.part.models["combinations"])

    def amount(self) -> int:
        """About as many rows, or models, are to be made."""
        number = _number(self.combinations)
        return number * self.part.pairs if self.round else number

    def missing(self) -> list[str]:
        """Modules that it needs and that are not installed."""
        return [name for name in self.part.needs if importlib.util.find_spec(name) is None]

    def seconds(self, measured: Mapping[str, Mapping[str, float]]) -> float:
        """CPU seconds that it takes: as measured by an earlier piece of it, else as configured."""
        known = measured.get(self.name, {})
        if known.get("rows"):
            return self.amount() * known["seconds"] / known["rows"]
        each = self.round.seconds_per_row if self.round else self.part.models["seconds_each"]
        return float(self.amount() * each * self.part.factor)


@cache
def _number(combinations: str) -> int:
    """How many combinations patterns select here."""
    return len(select(installed_methods(), combinations))


@dataclass(frozen=True)
class Plan:
    """The steps of a study, in order, and the flights that it makes itself."""

    steps: tuple[Step, ...]
    flights: Mapping[str, Mapping[str, Any]]
    max_megabytes: float

    def of(self, parts: Sequence[str]) -> tuple[Step, ...]:
        """The steps of some parts, of all if none is named; ArgumentError if one is unknown."""
        known = {step.part.name for step in self.steps}
        for name in parts:
            if name not in known:
                raise ArgumentError(f"there is no part {name!r}; there are {', '.join(known)}")
        return tuple(step for step in self.steps if not parts or step.part.name in parts)


def images_of(part: Part, data: Path | str, flights: Path | str) -> str:
    """The images of a part in text form, as `aerocues.open_dataset` takes it."""
    return part.dataset.format(data=data, flights=flights)


def _checked(step: Step) -> Step:
    """The step; TypeError, ValueError or AerocuesError where it cannot be measured."""
    try:
        images_of(step.part, "", "")
        if not step.missing():
            float(step.seconds({}))
    except LookupError as error:
        raise ValueError(f"{step.name} needs {error}, which does not exist") from error
    return step


def read_plan(file: Path = CONFIGURATION) -> Plan:
    """Read a configuration: all parts in the first round, then all parts in the second, and so on.

    Raises
    ------
    ArgumentError
        If it is not of the form that it must have.
    """
    try:
        with file.open("rb") as opened:
            content = tomllib.load(opened)
        defaults = content.get("defaults", {})
        rounds = {each["name"]: Round(**each) for each in content["round"]}
        parts = [_part(each, defaults, tuple(rounds)) for each in content["part"]]
        steps = tuple(_checked(step) for step in _steps(parts, rounds))
        return Plan(steps, content.get("flight", {}), float(content["max_megabytes"]))
    except (OSError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise ArgumentError(f"cannot read {file}: {error}; correct it") from error


def _part(row: Mapping[str, Any], defaults: Mapping[str, Any], rounds: tuple[str, ...]) -> Part:
    merged = {key: {**defaults.get(key, {}), **row.get(key, {})} for key in ("open", "run")}
    lists = {key: tuple(row[key]) for key in ("rounds", "needs") if key in row}
    return Part(**{"rounds": rounds, **row, **lists, **merged})


def _steps(parts: Sequence[Part], rounds: Mapping[str, Round]) -> Iterator[Step]:
    for part in parts:
        for name in part.rounds:
            if name not in rounds:
                raise ValueError(f"{part.name} names the round {name!r}, which does not exist")
    for name, each in rounds.items():
        yield from (Step(part, each) for part in parts if name in part.rounds)
        # Models are stored with the rows of a part: its first round must be there.
        yield from (Step(p, None) for p in parts if p.models and p.rounds[0] == name)
