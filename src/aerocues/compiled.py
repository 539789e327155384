"""Numba's compiler with the settings that all kernels share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from aerocues.errors import MethodUnavailableError

try:
    import numba
except ImportError as error:  # missing, as in the light install, or at odds with another package
    raise MethodUnavailableError(
        f"this needs code that numba compiles, and numba cannot be loaded ({error}); "
        "install it: pip install numba"
    ) from error

__all__ = ["compiled", "numba"]

_Function = TypeVar("_Function", bound=Callable[..., Any])


def compiled(function: _Function) -> _Function:
    """Compile a function when it is first called, and keep the machine code on disk.

    Without fast mathematics: the same scene must give the same bytes everywhere. Kernels release
    the interpreter's lock and use one thread.

    Numba looks for changes in the file of a function only, not in those of the functions that it
    calls: after changing a kernel that another file calls, remove this folder's ``__pycache__``.
    """
    compile_it = numba.njit(cache=True, nogil=True, error_model="numpy")
    return cast("_Function", compile_it(function))
