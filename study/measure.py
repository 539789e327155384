"""Measure the study: `make study`, or `python -m study.measure --help`.

It goes on where it stopped, row by row; after each step the part is stored in the database.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import aerocues
from aerocues.arguments import seconds_of
from aerocues.cli.interruption import Interrupted, interruptible
from aerocues.errors import AerocuesError, ArgumentError, DatasetError, StoreError
from aerocues.evaluation.dask_scheduler import connected
from aerocues.phrases import count, spoken_seconds
from aerocues.progress import Event
from aerocues.results.store import RUN
from aerocues.results.study import FACTS, add_part
from study.flights import make_flight
from study.outdated import drop_outdated
from study.plan import CONFIGURATION, FOLDER, UNFINISHED, Plan, Step, images_of, read_plan

DATABASE, WORK = FOLDER / "database", FOLDER / "work"
DATA = Path(os.environ.get("AEROCUES_SHARED_DATA", FOLDER.parent.parent / "shared" / "data"))
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
    """

    plan: Plan
    data: Path
    work: Path
    database: Path
    budget: float | None = None
    engine: Any = None
    workers: int | None = None
    tell: Callable[[str], None] = print
    _began: float = field(default_factory=time.monotonic)
    _told: float = 0.0

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
            if self.steps(step.part.name).get(step.short_name, {}).get("finished") == step.asked():
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
        part, steps = step.part, self.steps(step.part.name)
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

    def _same_rows(self, part: str) -> bool:
        """Whether the database has the rows of the results folder."""
        new, kept = (
            aerocues.Results(place / part).table().select("row_key", "measured_at")
            for place in (self.work, self.database)
        )
        return new.equals(kept)

    def _restore(self, step: Step) -> None:
        """Go on from the database where the results folder is gone, without outdated rows."""
        kept, folder = self.database / step.part.name, self.work / step.part.name
        if (kept / RUN).is_file() and not (folder / RUN).is_file():
            shutil.copytree(kept, folder, dirs_exist_ok=True)
        if (folder / RUN).is_file() and (number := drop_outdated(folder, step.part)):
            self.tell(f"{step.part.name}: {count(number, 'row')} of other parameters left out")

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
        # As for models: what the preset itself finds is studied.
        arguments = {"equal_footing": False, **step.part.run, **step.round.run}
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


def print_hours(steps: Sequence[Step], measured: Mapping[str, Mapping[str, float]]) -> None:
    """The rows and CPU hours of each step, and of all."""
    total = 0.0
    for step in steps:
        if missing := step.missing():
            print(f"{step.name:34s} needs {', '.join(missing)}")
            continue
        seconds = step.seconds(measured)
        total += seconds
        unit = "row" if step.round else "model"
        print(f"{step.name:34s} {count(step.amount(), unit):>14s} {seconds / 3600:6.2f} CPU h")
    print(f"{'all':34s} {'':14s} {total / 3600:6.2f} CPU h")


def parser() -> argparse.ArgumentParser:
    """The options of the program."""
    made = argparse.ArgumentParser(description="Measure the study, or go on with it.")
    made.add_argument("--configuration", type=Path, default=CONFIGURATION)
    made.add_argument("--only", action="append", default=[], metavar="PART")
    made.add_argument("--budget", metavar="TIME", help="stop after this time, such as 30min")
    made.add_argument("--dry-run", action="store_true", help="print the hours of each step")
    made.add_argument("--verify", action="store_true", help="measure 5 %% of the rows again")
    made.add_argument("--seed", type=int, default=1, help="draws these rows; the same for the same")
    made.add_argument("--workers", type=int, metavar="N")
    made.add_argument("--engine", choices=("local", "dask"), default="local")
    made.add_argument("--scheduler", metavar="ADDRESS", help="of Dask, tcp://host:8786")
    made.add_argument("--data", type=Path, default=DATA, metavar="DIR", help="real images")
    made.add_argument("--work", type=Path, default=WORK, metavar="DIR")
    made.add_argument("--database", type=Path, default=DATABASE, metavar="DIR")
    return made


def main(words: Sequence[str] | None = None) -> int:
    """The program; 0 if the study is finished, `UNFINISHED` if not, 2 for wrong input."""
    asked = parser().parse_args(words)
    try:
        # Signals become exceptions: what was measured so far is stored with its CPU time.
        with interruptible(), _engine(asked) as engine:
            return _done(asked, engine)
    except Interrupted as interruption:
        print("interrupted; the same command goes on from here", file=sys.stderr)
        return interruption.exit_code
    except BudgetSpentError:
        print("the budget is spent before everything was measured again", file=sys.stderr)
        return UNFINISHED
    except (AerocuesError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


def _done(asked: argparse.Namespace, engine: Any) -> int:
    study = Study(
        plan=read_plan(asked.configuration),
        data=asked.data,
        work=asked.work,
        database=asked.database,
        budget=None if asked.budget is None else seconds_of("budget", asked.budget),
        engine=engine,
        workers=asked.workers,
    )
    if asked.dry_run:
        print_hours(study.plan.of(asked.only), study.measured())
        return 0
    if asked.verify:
        from study.verify import verify

        return verify(study, asked.only, asked.seed)
    return 0 if study.measure(asked.only) else UNFINISHED


@contextmanager
def _engine(asked: argparse.Namespace) -> Iterator[Any]:
    """What measures; None for processes of this machine."""
    if (asked.engine == "dask") != (asked.scheduler is not None):
        raise ArgumentError("give --engine dask and --scheduler tcp://HOST:8786 together")
    if asked.scheduler is None:
        yield None
        return
    with connected(asked.scheduler) as client:
        yield aerocues.DaskEngine(client)


if __name__ == "__main__":
    sys.exit(main())
