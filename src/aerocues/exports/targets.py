"""What a combination can be used as, one row each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import Any, Literal

from aerocues.arguments import check_choice
from aerocues.errors import MethodUnavailableError

Kind = Literal["program", "files", "settings"]


@dataclass(frozen=True)
class Target:
    """One way to use a combination.

    Parameters
    ----------
    name : str
        As users write it.
    title : str
        What it is.
    kind : {"program", "files", "settings"}
        A ``program`` is written from the parameters of the combination alone; ``files`` are those
        of another tool, with the features, matches and verified pairs of a flight; ``settings``
        are what comes nearest in a tool with a fixed list of features.
    writer : str
        Its function, as ``module:function`` of this package.
    conventions : str
        Where the format has the centre of the top-left pixel, and in what units.
    needs : str
        A package that is not installed with aerocues.
    separator : str
        The character between names in its files, which names of images cannot have then.
    """

    name: str
    title: str
    kind: Kind
    writer: str
    conventions: str = ""
    needs: str = ""
    separator: str = ""

    def load(self) -> Callable[..., Any]:
        """The function that writes it.

        Raises
        ------
        MethodUnavailableError
            If it needs a package that is not installed.
        """
        if self.needs and find_spec(self.needs) is None:
            raise MethodUnavailableError(
                f"files of {self.name} need {self.needs}, which is not installed; install it with: "
                "pip install 'aerocues[exports]'"
            )
        module, _, function = self.writer.partition(":")
        found: Callable[..., Any] = getattr(import_module(f"aerocues.exports.{module}"), function)
        return found


TARGETS: tuple[Target, ...] = (
    Target("python", "a Python program", "program", "python_program:python_program"),
    Target("cpp", "a C++ program", "program", "cpp_program:cpp_program"),
    Target(
        "colmap",
        "images, and a database for COLMAP",
        "files",
        "colmap:write_colmap",
        "(0.5, 0.5), pixels",
    ),
    Target(
        "hloc",
        "images, `feats.h5`, `matches.h5` and `pairs.txt` of hloc",
        "files",
        "hloc:write_hloc",
        "(0, 0), pixels",
        needs="h5py",
        separator=" ",
    ),
    Target(
        "opensfm",
        "an OpenSfM dataset whose features and matches are done",
        "files",
        "opensfm:write_opensfm",
        "from the centre of the image, in parts of its longer side",
    ),
    Target(
        "odm",
        "an ODM (OpenDroneMap) project whose features and matches are done",
        "files",
        "opensfm:write_odm",
        "from the centre of the image, in parts of its longer side",
    ),
    Target(
        "openmvg",
        "views, regions and matches of OpenMVG",
        "files",
        "openmvg:write_openmvg",
        "(0, 0), pixels",
    ),
    Target(
        "bundler",
        "keys, matches and options of Bundler",
        "files",
        "bundler:write_bundler",
        "(0, 0), pixels, row before column",
        separator=" ",
    ),
    Target(
        "kapture",
        "a kapture dataset",
        "files",
        "kapture:write_kapture",
        "(0.5, 0.5), pixels",
        separator=",",
    ),
    Target("rtabmap", "arguments of RTAB-Map", "settings", "rtabmap:rtabmap_settings"),
    Target("odm-options", "options of ODM", "settings", "odm_options:odm_options"),
)


def target_named(name: str) -> Target:
    """The row of a target; ArgumentError if there is none."""
    check_choice("target", name, [each.name for each in TARGETS])
    return next(each for each in TARGETS if each.name == name)
