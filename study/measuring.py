"""The study as it is measured: step after step, each stored when it ends."""

from __future__ import annotations

import resource
import shutil
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import aerocues
from aerocues.errors import DatasetError, StoreError
from aerocues.phrases import count, spoken_seconds
from aerocues.progress import Event
from aerocues.results.store import RUN
from aerocues.results.study import FACTS, add_part
from study.flights import make_flight
from study.machines import remove_rows_of_others, rows_of_others
from study.outdated import drop_outdated
from study.plan import MODELS, Plan, Step, images_of

TOLD_EVERY = 60.0


class BudgetSpentError(Exception):
    """The time that was given is up; what is finished is stored."""


@dataclass
class Study:
    """A study that is being measured.

    Parameters
    ----------
    plan : Plan
    data : path
        Folder of the real images.
    work : path
        Folder of the results folders and flights; large, and not part of the database.
    database : path
    budget : float or None
        Wall seconds until it stops; None for no limit.
    engine : Engine, optional
        Where units run; by default worker processes on this machine.
    workers : int, optional
    tell : callable
        Called with lines about the progress.
    one_machine : bool
        Measure rows of other kinds of machine again, so that the times of a part compare.
    """

    plan: Plan
    data: Path
    work: Path
    database: Path
    budget: float | None = None
    engine: Any = None
    workers: int | None = None
    tell: Callable[[str], None] = print
    one_machine: bool = False
    _began: float = field(default_factory=time.monotonic)
    _told: float = 0.0
    _kept: dict[str, float] = field(default_factory=dict)
    """Share of the rows of a part that stayed, where some were left out."""

    def facts(self, part: str) -> dict[str, Any]:
        """What the database tells of a part besides its rows."""
        folder = self.database / part
        if not (folder / RUN).is_file():
            return {}
        return dict(aerocues.Results(folder).settings.get(FACTS, {}))

    def steps(self, part: str) -> dict[str, dict[str, Any]]:
        """What it tells of the steps of a part: CPU seconds, rows, what was asked."""
        return dict(self.facts(part).get("steps", {}))

    def measured(self) -> dict[str, dict[str, Any]]:
        """CPU seconds and rows of each step so far, by the name of the step."""
        parts = dict.fromkeys(step.part.name for step in self.plan.steps)
        known = {part: self.steps(part) for part in parts}
        return {f"{part} {name}": row for part in parts for name, row in known[part].items()}

    def measure(self, parts: Sequence[str] = ()) -> bool:
        """Measure the parts, all by default; whether they are finished.

        Those whose images or modules are missing are skipped, which is told.
        """
        skipped = 0
        for step in self.plan.of(parts):
            if missing := step.missing():
                self.tell(f"{step.name}: skipped, as {', '.join(missing)} is not installed")
                skipped += 1
                continue
            if self._finished(step):
                continue
            try:
                self.make(step)
            except DatasetError as error:
                self.tell(f"{step.name}: skipped: {error}")
                skipped += 1
            except BudgetSpentError:
                self.tell(f"{step.name}: the budget is spent; the same command goes on from here")
                return False
        if skipped:
            self.tell(f"not finished: {count(skipped, 'step')} skipped")
        return not skipped

    def _finished(self, step: Step) -> bool:
        """Whether the database has all of a step as it is asked for."""
        part = step.part.name
        if self.steps(part).get(step.short_name, {}).get("finished") != step.asked():
            return False
        return not (self.one_machine and step.round and rows_of_others(self.database / part))

    def make(self, step: Step) -> None:
        """Make one step, or what is left of it, and store the part, finished or not."""
        self._restore(step)
        before, used, finished = self._amount(step), _cpu_seconds(), False
        try:
            self._measure_rows(step) if step.round else self._make_models(step)
            finished = True
        finally:
            if (self.work / step.part.name / RUN).is_file():
                made = self._amount(step) - before
                self.store(step, _cpu_seconds() - used, made, finished=finished)

    def store(self, step: Step, seconds: float, rows: int, *, finished: bool) -> None:
        """Store the part of a step in the database; StoreError if that becomes too large."""
        part = step.part
        steps = self._of_kept_rows(part.name, self.steps(part.name))
        old = steps.get(step.short_name, {"seconds": 0.0, "rows": 0})
        steps[step.short_name] = {
            "seconds": round(old["seconds"] + seconds, 1),
            "rows": old["rows"] + rows,
            # What was finished under another configuration is still whole.
            "finished": step.asked() if finished else old.get("finished"),
        }
        hours = round(sum(each["seconds"] for each in steps.values()) / 3600, 4)
        known = self.facts(part.name)
        if "verified" in known and not self._same_rows(part.name):
            del known["verified"]
        facts = {
            **known,
            "title": part.title,
            "licence": part.licence,
            "cpu_hours": hours,
            "steps": steps,
        }
        add_part(self.database, part.name, self.work / part.name, facts)
        size = sum(file.stat().st_size for file in self.database.rglob("*.parquet")) / 1e6
        self.tell(f"{step.name}: {count(rows, 'row')} stored; the database has {size:.1f} MB")
        if size > self.plan.max_megabytes:
            raise StoreError(
                f"the database has {size:.1f} MB, more than {self.plan.max_megabytes:g}; "
                "leave a part out"
            )

    def _of_kept_rows(
        self, part: str, steps: Mapping[str, Mapping[str, Any]]
    ) -> dict[str, dict[str, Any]]:
        """What is told of the steps of a part, where rows were left out of it."""
        share = self._kept.pop(part, 1.0)
        if share == 1.0:
            return {name: dict(told) for name, told in steps.items()}
        rounds = {
            name: {
                "seconds": told["seconds"] * share,
                "rows": round(told["rows"] * share),
                "finished": None,
            }
            for name, told in steps.items()
            if name != MODELS
        }
        return {name: rounds.get(name, dict(told)) for name, told in steps.items()}

    def _same_rows(self, part: str) -> bool:
        """Whether the database has the rows of the results folder."""
        new, kept = (
            aerocues.Results(place / part).table().select("row_key", "measured_at")
            for place in (self.work, self.database)
        )
        return new.equals(kept)

    def _restore(self, step: Step) -> None:
        """Go on from the database where the results folder is gone, without rows to replace."""
        kept, folder = self.database / step.part.name, self.work / step.part.name
        if (kept / RUN).is_file() and not (folder / RUN).is_file():
            shutil.copytree(kept, folder, dirs_exist_ok=True)
        if not (folder / RUN).is_file():
            return
        reasons = {"other parameters": drop_outdated(folder, step.part)}
        if self.one_machine:
            reasons["other machines"] = remove_rows_of_others(folder)
        if number := sum(reasons.values()):
            left = len(aerocues.Results(folder).table())
            self._kept[step.part.name] = left / (left + number)
        for reason, number in reasons.items():
            if number:
                self.tell(f"{step.part.name}: {count(number, 'row')} of {reason} left out")

    def dataset(self, step: Step) -> aerocues.Dataset:
        """The images of a step, with the pairs to measure."""
        return aerocues.open_dataset(self.images(step), **step.part.open)

    def images(self, step: Step) -> str:
        """The images of a step in text form; flights are made where they are missing."""
        part, flights = step.part, self.work / "flights"
        for name, settings in self.plan.flights.items():
            if f"{{flights}}/{name}" in part.dataset:
                make_flight(settings, flights / name, self.data, self.watch)
        return images_of(part, self.data, flights)

    def watch(self, event: Event) -> None:
        """Tell how it goes on once a minute; BudgetSpentError when the time is up."""
        now = time.monotonic()
        if now - self._told > TOLD_EVERY:
            self._told = now
            self.tell(f"  {spoken_seconds(now - self._began)}: {event}")
        if self.budget is not None and now - self._began > self.budget:
            raise BudgetSpentError

    def _measure_rows(self, step: Step) -> None:
        assert step.round is not None
        arguments = {**step.part.settings, **step.round.run}
        engine = {"workers": self.workers} if self.engine is None else {"engine": self.engine}
        aerocues.run(
            self.dataset(step),
            step.combinations,
            self.work / step.part.name,
            **arguments,
            **engine,
            progress=self.watch,
        )

    def _make_models(self, step: Step) -> None:
        terms = dict(step.part.models)
        for name in ("combinations", "seconds_each"):
            terms.pop(name)
        results = self.work / step.part.name
        aerocues.reconstruct(
            self.images(step),
            step.combinations,
            self.work / f"{step.part.name}-models",
            results=results,
            **{"equal_footing": False, "workers": self.workers, **terms},
            progress=self.watch,
        )

    def _amount(self, step: Step) -> int:
        """Rows, or models, that are there."""
        folder = self.work / step.part.name
        if not (folder / RUN).is_file():
            return 0
        results = aerocues.Results(folder)
        return len(results.table() if step.round else results.reconstructions())


def _cpu_seconds() -> float:
    """CPU seconds of this process and its finished workers, without those of a cluster."""
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(each.ru_utime + each.ru_stime for each in used)
