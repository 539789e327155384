"""A combination as a Python program in OpenCV alone."""

from __future__ import annotations

from aerocues.exports.program import filled
from aerocues.exports.recipe import Attempt, Recipe
from aerocues.methods.descriptors import DescriptorRow
from aerocues.methods.detectors import DetectorRow
from aerocues.methods.opencv import SEARCH_PARAMETERS
from aerocues.methods.parameters import Value
from aerocues.methods.positions import OWN_PARAMETERS

EQUALIZERS = {"histogram": "cv2.equalizeHist", "clahe": "cv2.createCLAHE(2.0, (8, 8)).apply"}


def python_program(recipe: Recipe) -> str:
    """The program that does what was measured, bit for bit with the same version of OpenCV."""
    search = {name: recipe.matcher[name] for name in recipe.matcher if name in SEARCH_PARAMETERS}
    values = {
        "detector": _made(recipe.detector),
        "descriptor": _made(recipe.descriptor),
        "equalizer": EQUALIZERS.get(recipe.measured.equalize),
        "index": {name: value for name, value in recipe.matcher.items() if name not in search},
        "search": search,
        "attempts": "\n".join(map(_attempt, recipe.attempts())),
    }
    return filled("program.py.template", recipe, values)


def _made(row: DetectorRow | DescriptorRow) -> str:
    known = {name: value for name, value in row.parameters.items() if name not in OWN_PARAMETERS}
    arguments = "".join(f"    {name}={_value(value)},\n" for name, value in known.items())
    return f'opencv("{row.factory}").create(\n{arguments})'


def _value(value: Value) -> str:
    if isinstance(value, str):
        return f'opencv("{value.replace(".", "_")}")'
    return repr(value)


def _attempt(attempt: Attempt) -> str:
    find = "cv2.findHomography" if attempt.homography else "cv2.findFundamentalMat"
    return f"    ({find}, {attempt.guided}, {attempt.iterations}, {attempt.factor}),"
