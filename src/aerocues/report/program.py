"""The program of the page: JavaScript modules joined into one script."""

from __future__ import annotations

import posixpath
import re
from graphlib import TopologicalSorter
from importlib.resources.abc import Traversable

START = "start.js"
# The only forms of import and export that the modules use.
IMPORT = re.compile(r'^import \{([^}]+)\} from "([^"]+)";\n', re.MULTILINE)
EXPORT = re.compile(r"^export (?=(?:async function|function|const) (\w+))", re.MULTILINE)


def program_of(folder: Traversable) -> str:
    """`start.js` and all modules that it imports, each in its own scope.

    Each module becomes a function that is called once and returns the exports. Browsers do not load
    modules of a page that is opened as a file, and a bundler would need a build step.

    Parameters
    ----------
    folder : Traversable
        Folder of the modules. Modules that are not imported are left out.

    Raises
    ------
    graphlib.CycleError
        If modules import each other.
    """
    sources = _sources(folder)
    imported = {name: _imports(name, text) for name, text in sources.items()}
    order = TopologicalSorter(imported).static_order()
    return "\n".join(_scoped(name, sources[name]) for name in order)


def _sources(folder: Traversable) -> dict[str, str]:
    """Text of each module, by its path in the folder."""
    found: dict[str, str] = {}
    waiting = [START]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found[name] = folder.joinpath(*name.split("/")).read_text(encoding="utf-8")
            waiting += _imports(name, found[name])
    return found


def _imports(name: str, text: str) -> list[str]:
    return [_resolved(name, path) for _, path in IMPORT.findall(text)]


def _resolved(name: str, path: str) -> str:
    """The path of an imported module; `path` is relative to the importing module."""
    return posixpath.normpath(posixpath.join(posixpath.dirname(name), path))


def _scoped(name: str, text: str) -> str:
    body = IMPORT.sub(
        lambda found: f"const {{{found[1]}}} = {_variable(_resolved(name, found[2]))};\n", text
    )
    exported = ", ".join(EXPORT.findall(text))
    body = EXPORT.sub("", body)
    return f"const {_variable(name)} = (() => {{\n{body}return {{{exported}}};\n}})();\n"


def _variable(name: str) -> str:
    return "module_" + re.sub(r"\W", "_", name.removesuffix(".js"))
