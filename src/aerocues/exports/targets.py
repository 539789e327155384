"""What a combination can be used as, one row each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Literal

from aerocues.arguments import check_choice

Kind = Literal["program"]


@dataclass(frozen=True)
class Target:
    """One way to use a combination.

    Parameters
    ----------
    name : str
        As users write it.
    title : str
        What it is.
    kind : {"program"}
        A ``program`` is written from the parameters of the combination alone.
    writer : str
        Its function, as ``module:function`` of this package.
    """

    name: str
    title: str
    kind: Kind
    writer: str

    def load(self) -> Callable[..., Any]:
        """The function that writes it."""
        module, _, function = self.writer.partition(":")
        found: Callable[..., Any] = getattr(import_module(f"aerocues.exports.{module}"), function)
        return found


TARGETS: tuple[Target, ...] = (
    Target("python", "a Python program", "program", "python_program:python_program"),
    Target("cpp", "a C++ program", "program", "cpp_program:cpp_program"),
)


def target_named(name: str) -> Target:
    """The row of a target; ArgumentError if there is none."""
    check_choice("target", name, [each.name for each in TARGETS])
    return next(each for each in TARGETS if each.name == name)
