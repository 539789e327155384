"""Measure the study: `make study`, or `python -m study.measure --help`.

It goes on where it stopped, row by row; after each step the part is stored in the database.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import aerocues
from aerocues.arguments import seconds_of
from aerocues.cli.interruption import Interrupted, interruptible
from aerocues.errors import AerocuesError, ArgumentError
from aerocues.evaluation.dask_scheduler import connected
from aerocues.phrases import count
from study.measuring import BudgetSpentError, Study
from study.plan import CONFIGURATION, FOLDER, UNFINISHED, Step, read_plan

DATABASE, WORK = FOLDER / "database", FOLDER / "work"
DATA = Path(os.environ.get("AEROCUES_SHARED_DATA", FOLDER.parent.parent / "shared" / "data"))


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
    made.add_argument(
        "--one-machine", action="store_true", help="measure rows of other kinds of machine again"
    )
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
        one_machine=asked.one_machine,
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
