"""What a plug-in says about itself, checked: nothing that it says may break a list of methods."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any, get_args

from aerocues.methods.descriptors import DescriptorType
from aerocues.methods.parameters import Value

# What Python asks of an entry point; versions of it differ in how they refuse others.
REFERENCE = re.compile(r"[\w.]+\s*(:\s*[\w.]+\s*)?(\[.*\]\s*)?")


@dataclass(frozen=True)
class Declaration:
    """What a plug-in says about itself, or why it cannot be used.

    Parameters
    ----------
    reference, title : str
        Where it was published and what it is.
    parameters : mapping
        Keyword arguments it is made with.
    dtype : {"uint8", "float32"}
        Type of the descriptors that a descriptor or extractor gives.
    dtypes : mapping of norm to descriptor types
        What a matcher takes.
    takes_descriptors : tuple of str
        Names of the only descriptors that a matcher takes, in capitals; empty: all.
    upright : bool
        Whether it expects images that are not turned against each other.
    on_request : str
        The set of methods in which it is offered; empty: it always takes part.
    limit : str
        The parameter by which a detector or extractor chooses the best so many keypoints; empty:
        there is none.
    needs_file : mapping of str to str
        A file without which it cannot run: see `why_no_file`; empty: it needs none.
    problem : str or None
        Why it cannot be used; the rest is then empty.
    """

    reference: str = ""
    title: str = ""
    parameters: Mapping[str, Value] = field(default_factory=dict)
    dtype: DescriptorType = "float32"
    dtypes: Mapping[str, tuple[DescriptorType, ...]] = field(default_factory=dict)
    takes_descriptors: tuple[str, ...] = ()
    upright: bool = False
    on_request: str = ""
    limit: str = ""
    needs_file: Mapping[str, str] = field(default_factory=dict)
    problem: str | None = None

    def why_not(self) -> str | None:
        """Why it cannot be used now, or None if it can."""
        return self.problem or why_no_file(self.needs_file)


def why_no_file(needed: Mapping[str, str]) -> str | None:
    """Why a file that a method needs is not there, or None if it is.

    Parameters
    ----------
    needed : mapping of str to str
        ``path``, where the file is; ``variable``, the environment variable that names another
        place; and ``remedy``, how to get it. Empty: none is needed.
    """
    if not needed:
        return None
    named = os.environ.get(needed.get("variable", ""))
    path = Path(named or needed["path"])
    try:
        path = path.expanduser()
        return None if path.is_file() else f"{path} does not exist; {needed['remedy']}"
    except (OSError, RuntimeError) as error:  # a name too long, a home of nobody
        reason = error.strerror if isinstance(error, OSError) else error
        return f"{path} cannot be opened ({reason}); {needed['remedy']}"


class _UnfitError(Exception):
    """Something that a plug-in says is not of the form that it must have."""


def read_declaration(entry: EntryPoint, group: str) -> Declaration:
    """Load a plug-in of a group, such as ``matchers``, and read what it says about itself."""
    if not REFERENCE.fullmatch(entry.value):
        return Declaration(
            problem=f"{entry.value} does not exist; an entry point is such as 'package.module:name'"
        )
    try:
        factory = entry.load()
        return Declaration(
            str(getattr(factory, "reference", "")),
            str(getattr(factory, "title", "")),
            _parameters(factory),
            _dtype(getattr(factory, "dtype", "float32"), "dtype"),
            _dtypes(factory) if group == "matchers" else {},
            _takes_descriptors(factory) if group == "matchers" else (),
            _upright(factory),
            _on_request(factory),
            _limit(factory) if group in ("detectors", "extractors") else "",
            _needs_file(factory),
        )
    except (_UnfitError, ImportError) as error:
        problem = str(error) or type(error).__name__
    except AttributeError as error:
        problem = f"{entry.value} does not exist: {error}"
    except (Exception, SystemExit) as error:  # noqa: BLE001 - third-party code may raise anything
        problem = f"{type(error).__name__}: {error}"
    return Declaration(problem=" ".join(problem.split()))


def _mapping(factory: Any, name: str, of_what: str) -> Mapping[Any, Any]:
    declared = getattr(factory, name, {})
    if not isinstance(declared, Mapping):
        kind = type(declared).__name__
        raise _UnfitError(f"its {name!r} must be a mapping of {of_what}, not a {kind}")
    return declared


def _parameters(factory: Any) -> dict[str, Value]:
    declared = dict(_mapping(factory, "parameters", "names to values"))
    try:
        written = json.dumps(declared)
    except (TypeError, ValueError) as error:
        raise _UnfitError(
            f"its 'parameters' must be numbers and texts, to become part of the record: {error}"
        ) from error
    if not all(isinstance(name, str) for name in declared):
        raise _UnfitError(f"the names of its 'parameters' must be texts: {written}")
    return declared


def _dtype(declared: Any, name: str) -> DescriptorType:
    for known in get_args(DescriptorType):
        if str(declared) == known:
            dtype: DescriptorType = known
            return dtype
    raise _UnfitError(f"its {name} must be 'uint8' or 'float32', not {declared!r}")


def _dtypes(factory: Any) -> dict[str, tuple[DescriptorType, ...]]:
    declared = _mapping(factory, "dtypes", "norms to descriptor types")
    if not declared:
        raise _UnfitError("it does not state which norms and descriptor types it takes ('dtypes')")
    return {
        str(norm): tuple(
            _dtype(dtype, f"dtypes under {norm}")
            for dtype in ((dtypes,) if isinstance(dtypes, str) else dtypes)
        )
        for norm, dtypes in declared.items()
    }


def _takes_descriptors(factory: Any) -> tuple[str, ...]:
    declared = getattr(factory, "takes_descriptors", ())
    names = (declared,) if isinstance(declared, str) else tuple(declared)
    if not all(isinstance(name, str) for name in names):
        raise _UnfitError(f"its 'takes_descriptors' must be names of descriptors, not {declared!r}")
    return tuple(name.upper() for name in names)


def _upright(factory: Any) -> bool:
    declared = getattr(factory, "upright", False)
    if not isinstance(declared, bool):
        raise _UnfitError(f"its 'upright' must be True or False, not {declared!r}")
    return declared


def _on_request(factory: Any) -> str:
    declared = getattr(factory, "on_request", "")
    if not isinstance(declared, str) or not re.fullmatch(r"\w*", declared):
        raise _UnfitError(f"its 'on_request' must be a name such as 'learned', not {declared!r}")
    return declared.lower()


def _limit(factory: Any) -> str:
    declared = getattr(factory, "limit", "")
    if declared and not isinstance(_parameters(factory).get(declared), int):
        raise _UnfitError(
            f"its 'limit' must name one of its 'parameters', a whole number, not {declared!r}"
        )
    return str(declared)


def _needs_file(factory: Any) -> dict[str, str]:
    declared = dict(_mapping(factory, "needs_file", "'path', 'variable' and 'remedy' to texts"))
    if declared and not {"path", "remedy"} <= declared.keys() <= {"path", "remedy", "variable"}:
        raise _UnfitError("its 'needs_file' must have a 'path', a 'remedy' and maybe a 'variable'")
    return {name: str(value) for name, value in declared.items()}
