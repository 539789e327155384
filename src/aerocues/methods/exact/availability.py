"""Whether exact matching can be had: its kernels need numba, which a light install leaves out."""

from __future__ import annotations

from importlib.util import find_spec


def why_not_exact() -> str | None:
    """Why descriptors cannot be matched exactly here, or None; numba is not loaded for it."""
    if find_spec("numba") is None:
        return "it needs numba, which is not installed; install it: pip install numba"
    return None
