"""All commands, and how errors become one line and an exit code."""

from __future__ import annotations

import contextlib
import os
import re
import sys
import warnings
from collections.abc import Iterator, Sequence
from typing import Annotated, Any, cast

import typer

from aerocues.cli import (
    airsim,
    compare,
    datasets,
    importing,
    methods,
    recommend,
    reconstruct,
    report,
    results,
    run,
    score,
    simulate,
    status,
    study,
    tune,
    use,
    validate,
)
from aerocues.cli.wording import in_options
from aerocues.errors import AerocuesError, DamageWarning
from aerocues.phrases import printable
from aerocues.standard_error import tell

BAD_INPUT = 2
INTERRUPTED = 130
BROKEN_PIPE = 141
# typer keeps the class that all mistakes on the command line share to itself.
UsageError = cast(
    "type[Exception]",
    next(kind for kind in typer.BadParameter.__mro__ if kind.__name__ == "ClickException"),
)

# What the validation behind typer says of numbers.
IN_PLAIN_WORDS = (
    (r"Input should be greater than or equal to (\S+)", r"give \1 or more"),
    (r"Input should be less than or equal to (\S+)", r"give \1 or less"),
    (r"Input should be a valid integer.*", "give a whole number"),
    (r"Input should be a valid number.*", "give a number"),
)

app = typer.Typer(
    help="Choose local features (detector, descriptor, matcher) for 3D models from drone images.",
    add_completion=False,
    rich_markup_mode=None,
)
app.command("recommend")(recommend.recommend)
app.command("run")(run.run)
app.command("status")(status.status)
app.command("results")(results.results)
app.command("import")(importing.import_table)
app.command("score")(score.score)
app.command("validate")(validate.validate)
app.command("compare")(compare.compare)
app.command("reconstruct")(reconstruct.reconstruct)
app.command("report")(report.report)
app.command("study")(study.study)
app.command("use")(use.use)
app.command("tune", short_help="Search parameters; keep those that help on other scenes.")(
    tune.tune
)
app.command("simulate")(simulate.simulate)
app.add_typer(airsim.app, name="airsim")
app.add_typer(methods.app, name="methods")
app.add_typer(datasets.app, name="datasets")


def _print_version(asked: bool) -> None:
    if asked:
        import aerocues

        typer.echo(f"aerocues {aerocues.__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", help="Print the version.", callback=_print_version, is_eager=True
        ),
    ] = False,
) -> None:
    """Options of the program itself."""


def exit_code(arguments: Sequence[str]) -> int:
    """Run a command; wrong input gives one line on standard error."""
    try:
        return _run(arguments)
    except BrokenPipeError:
        # The reader (head, less) has seen enough. Python would complain when it flushes at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except UsageError as error:
        return _complain(_told(error))
    except AerocuesError as error:
        return _complain(in_options(str(error), _parameters(arguments)))
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        return _complain(f"{where}{error.strerror or error}; check the path, access and free space")
    except MemoryError as error:
        told = f" ({error})" if str(error) else ""
        return _complain(
            f"there is not enough memory{told}; free some, or ask for less: fewer --workers, "
            "a smaller --max-width"
        )
    except (KeyboardInterrupt, typer.Abort) as interruption:
        tell("interrupted\n")
        return getattr(interruption, "exit_code", INTERRUPTED)


def _run(arguments: Sequence[str]) -> int:
    command = typer.main.get_command(app)
    try:
        words = list(arguments) or ["--help"]
        with _warnings_in_lines(arguments), command.make_context("aerocues", words) as context:
            command.invoke(context)
    except typer.Exit as finished:
        return finished.exit_code
    finally:
        sys.stdout.flush()
    return 0


@contextlib.contextmanager
def _warnings_in_lines(arguments: Sequence[str]) -> Iterator[None]:
    """Print each warning of damage once, in one line, as errors are; others as Python does."""
    with warnings.catch_warnings():
        as_python_does, said = warnings.showwarning, set()

        def show(message: Warning | str, category: type[Warning], *place: Any, **_: Any) -> None:
            if not issubclass(category, DamageWarning):
                as_python_does(message, category, *place)
            elif str(message) not in said:
                said.add(str(message))
                told = in_options(str(message), _parameters(arguments))
                tell(f"warning: {' '.join(told.split())}\n")

        warnings.showwarning = show
        warnings.simplefilter("always", DamageWarning)
        yield


def _parameters(arguments: Sequence[str]) -> list[Any]:
    """Parameters of the command that was called, then those of all commands."""
    program: Any = typer.main.get_command(app)
    called = program
    for word in arguments:
        if word not in getattr(called, "commands", {}):
            break
        called = called.commands[word]
    return [*called.params, *(each for one in program.commands.values() for each in one.params)]


def _told(error: Any) -> str:
    context = getattr(error, "ctx", None)
    command = context.command_path if context else "aerocues"
    message = error.format_message().replace("Value error, ", "").rstrip(".")
    for theirs, ours in IN_PLAIN_WORDS:
        message = re.sub(theirs, ours, message)
    return f"{message}; see '{command} --help'"


def _complain(message: str) -> int:
    tell(f"error: {printable(' '.join(message.split()))}\n")
    return BAD_INPUT
