"""Parameter values and how they become arguments of OpenCV, whatever its version."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import cv2

from aerocues.errors import MethodUnavailableError

Value = bool | int | float | str
OPENCV = "opencv"
AEROCUES = "aerocues"
NEXT_STEP = "install opencv-contrib-python-headless 4.11 to 5.x in place of other OpenCV builds"


def opencv_class(name: str) -> Any:
    """The class of OpenCV called `name`.

    OpenCV 5 moved AKAZE, KAZE, BRISK and AGAST to ``cv2.xfeatures2d``, with their constants.

    Raises
    ------
    MethodUnavailableError
        If this build of OpenCV has no such class.
    """
    for namespace in (cv2, getattr(cv2, "xfeatures2d", None)):
        found = getattr(namespace, name, None)
        if found is not None:
            return found
    raise MethodUnavailableError(f"this OpenCV ({cv2.__version__}) has no {name}; {NEXT_STEP}")


def why_missing(factory: str) -> str | None:
    """Why a class of OpenCV cannot be used here, or None where it is there."""
    try:
        opencv_class(factory)
    except MethodUnavailableError as error:
        return str(error)
    return None


def _constant(text: str) -> Any:
    """The value of a constant such as ``KAZE.DIFF_PM_G2``; older builds spell it ``KAZE_...``."""
    owner, name = text.split(".")
    found = getattr(opencv_class(owner), name, None)
    if found is not None:
        return found
    return opencv_class(f"{owner}_{name}")


def create_opencv(factory: str, parameters: Mapping[str, Value]) -> Any:
    """Make an OpenCV feature object from a class name and its parameters.

    Parameters
    ----------
    factory : str
        Name of the class, such as ``AKAZE``.
    parameters : mapping
        Keyword arguments of ``create``; ``KAZE.DIFF_PM_G2`` names a constant of a class.

    Raises
    ------
    MethodUnavailableError
        If this build of OpenCV has no such class, constant or parameter.
    """
    arguments = {
        name: _constant(value) if isinstance(value, str) else value
        for name, value in parameters.items()
    }
    try:
        return opencv_class(factory).create(**arguments)
    except (cv2.error, TypeError, AttributeError) as error:
        raise MethodUnavailableError(
            f"OpenCV {cv2.__version__} cannot make {factory} with {dict(parameters)}: "
            f"{str(error).strip()}; {NEXT_STEP}"
        ) from error
