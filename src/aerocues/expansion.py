"""How much a packed file may become: a few kilobytes may stand for gigabytes."""

from __future__ import annotations

LARGEST_SMALL = 512 * 2**20
"""Bytes that any file may become."""
LARGEST_RATIO = 60
"""Larger files may become so many times their own size; rows of a run become 5 to 10 times."""


def why_too_large(size: int, expanded: int) -> str | None:
    """Why a file of so many bytes that would become so many is not to be expanded, or None."""
    if expanded <= max(LARGEST_SMALL, LARGEST_RATIO * size):
        return None
    return f"its {size:,} bytes would become {expanded / 1e9:.1f} GB"
