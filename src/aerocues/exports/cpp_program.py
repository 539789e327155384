"""A combination as a C++ program in OpenCV alone."""

from __future__ import annotations

from collections.abc import Mapping

from aerocues.exports.program import filled
from aerocues.exports.recipe import Attempt, Recipe
from aerocues.methods.descriptors import DescriptorRow
from aerocues.methods.detectors import DetectorRow
from aerocues.methods.opencv import SEARCH_PARAMETERS
from aerocues.methods.parameters import Value
from aerocues.methods.positions import OWN_PARAMETERS

NEWER: Mapping[tuple[str, str], str] = {
    ("SIFT", "enable_precise_upscale"): "4, 8",
    ("AKAZE", "max_points"): "4, 9",
}
"""Last arguments that OpenCV has since a version."""
BEFORE: Mapping[tuple[str, str], str] = {("DAISY", "interpolation"): "noArray()"}
"""Arguments that Python leaves out, by the one that they stand before."""
EQUALIZERS = {
    "histogram": "equalizeHist(plane, plane);",
    "clahe": "createCLAHE(2.0, Size(8, 8))->apply(plane, plane);",
}


def cpp_program(recipe: Recipe) -> str:
    """The program that does what was measured."""
    values = {
        "detector": _made(recipe.detector),
        "descriptor": _made(recipe.descriptor),
        "equalizer": EQUALIZERS.get(recipe.measured.equalize),
        "index": "\n".join(_flann(name, value) for name, value in recipe.matcher.items()),
        "attempts": "\n".join(map(_attempt, recipe.attempts())),
    }
    return filled("program.cpp.template", recipe, values)


def _made(row: DetectorRow | DescriptorRow) -> str:
    """The call that makes a method: arguments of C++ have no names, so all are given in order."""
    arguments, newer = [], ""
    for name, value in row.parameters.items():
        if name in OWN_PARAMETERS:
            continue
        if (row.factory, name) in NEWER:
            version = NEWER[row.factory, name]
            newer += f"\n#if AT_LEAST({version})\n        , {_value(value)}\n#endif\n    "
            continue
        if (row.factory, name) in BEFORE:
            arguments.append(BEFORE[row.factory, name])
        arguments.append(_value(value))
    return f"{row.factory}::create({', '.join(arguments)}{newer})"


def _value(value: Value) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return value.replace(".", "::") if isinstance(value, str) else repr(value)


def _flann(name: str, value: Value) -> str:
    owner = "search" if name in SEARCH_PARAMETERS else "index"
    if name == "algorithm":
        return f"    {owner}->setAlgorithm({value});"
    kind = "Bool" if isinstance(value, bool) else "Int" if isinstance(value, int) else "Double"
    return f'    {owner}->set{kind}("{name}", {_value(value)});'


def _attempt(attempt: Attempt) -> str:
    values = (_value(each) for each in (attempt.homography, attempt.guided))
    return f"    {{{', '.join(values)}, {attempt.iterations}, {attempt.factor}}},"
