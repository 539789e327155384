"""A combination as a program in OpenCV alone: what programs in all languages have in common."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files
from string import Template

from aerocues.exports.levels import LEVELS
from aerocues.exports.recipe import Recipe
from aerocues.methods.matchers import NORMS

FOLDER = "programs"


def program_name(recipe: Recipe) -> str:
    """The name of the program's file, without its ending."""
    return str(recipe.combination).lower().replace("-", "_")


def filled(template: str, recipe: Recipe, values: Mapping[str, object]) -> str:
    """A template with what all languages need and the values of one language in their places.

    Parameters
    ----------
    template : str
        Name of the file. Lines ``%if NAME`` and ``%if not NAME`` to ``%end`` stand only where it
        is, or is not, so; ``$name`` is a value.
    recipe : Recipe
    values : mapping
    """
    text = files("aerocues.exports").joinpath(FOLDER, template).read_text(encoding="utf-8")
    facts = _facts(recipe)
    chosen = "".join(_chosen(text, facts))
    return Template(chosen).substitute({**_values(recipe), **values})


def _facts(recipe: Recipe) -> dict[str, bool]:
    """What decides which parts of a program there are."""
    level = LEVELS.get(recipe.detector.factory)
    limit = recipe.protocol.limit
    return {
        "shifted": recipe.shifted is not None,
        "resized": level is not None and level.resized,
        "told": recipe.told,
        "levels": recipe.shifted is not None or recipe.told,
        "floor": recipe.shifted is not None and level is not None and "floor(" in level.extent,
        "limited": limit.count > 0,
        "spread": limit.spread,
        "gray": recipe.gray,
        "numbers": recipe.descriptor.dtype == "float32",
        "brute_force": recipe.brute_force,
        "shrunk": bool(recipe.measured.max_width),
        "equalized": recipe.measured.equalize != "none",
    }


def _values(recipe: Recipe) -> dict[str, object]:
    """What all languages write alike."""
    verification = recipe.protocol.verification
    values: dict[str, object] = {
        "combination": recipe.combination,
        "name": program_name(recipe),
        "seed": recipe.protocol.seed,
        "threshold": verification.threshold,
        "confidence": verification.confidence,
        "minimum": verification.minimum_matches,
        "shuffles": recipe.shuffles,
        "count": recipe.protocol.limit.count,
        "norm": {row.name: row.constant for row in NORMS}[recipe.combination.norm],
        "max_width": recipe.measured.max_width,
    }
    for role, row in (("detector", recipe.detector), ("descriptor", recipe.descriptor)):
        if row.factory in LEVELS:
            level = LEVELS[row.factory].filled(row.parameters)
            values |= {f"{role}_{name}": text for name, text in vars(level).items()}
    return values


def _chosen(text: str, facts: Mapping[str, bool]) -> list[str]:
    """The lines that stand where the facts are as they are."""
    standing: list[bool] = []
    lines = []
    for line in text.splitlines(keepends=True):
        words = line.split()
        if words[:1] == ["%if"]:
            standing.append(facts[words[-1]] != (words[1] == "not"))
        elif words[:1] == ["%end"]:
            standing.pop()
        elif all(standing):
            lines.append(line)
    return lines
