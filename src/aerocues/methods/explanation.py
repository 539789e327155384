"""What becomes of a combination, in words."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

from aerocues.errors import SelectionError
from aerocues.methods.combination import NONE
from aerocues.methods.compatibility import why_incompatible, why_meaningless, why_unavailable
from aerocues.methods.registry import Methods
from aerocues.methods.selection import runnable

LISTED = 4


def explain(text: str, methods: Methods) -> str:
    """Say whether the combination `text` runs, and why not if it does not.

    Raises
    ------
    SelectionError
        If `text` is no combination or a name in it does not exist, with those that are close.
    """
    if beginning := _beginning(text, methods):
        raise SelectionError(beginning)
    combination = methods.parse(text)
    for kind, name, known in (
        ("detector", combination.detector, methods.detectors),
        ("descriptor", combination.descriptor, methods.descriptors),
        ("norm", combination.norm, methods.norms),
        ("matcher", combination.matcher, methods.matchers),
    ):
        if name not in known:
            raise SelectionError(f"there is no {kind} {name}; {_close(name, known)}")
    incompatible = why_incompatible(combination, methods)
    if incompatible:
        return f"{combination} cannot run: {incompatible}"
    unavailable = why_unavailable(combination, methods)
    if unavailable:
        return f"{combination} cannot run here: {unavailable}"
    meaningless = why_meaningless(combination, methods)
    if meaningless:
        return f"{combination} runs but means nothing: {meaningless}"
    if methods.descriptors[combination.descriptor].needs_colour:
        return f"{combination} runs; with gray images it is left out, because it compares colours"
    return f"{combination} runs"


def _beginning(text: str, methods: Methods) -> str | None:
    """Which combinations a text may be the beginning of; None if it is none."""
    start = f"{text.strip().upper()}-"
    if text.strip().upper() in methods.pair_matchers:
        return None
    whole = [str(each) for each in runnable(methods) if str(each).startswith(start)]
    if not whole:
        return None
    more = f" and {len(whole) - LISTED} more" if len(whole) > LISTED else ""
    return (
        f"{text} is the beginning of {', '.join(whole[:LISTED])}{more}; name one, or see all with "
        f"aerocues methods list --all '{start}*'"
    )


def _close(name: str, known: Iterable[str]) -> str:
    names = [name for name in known if name != NONE]
    close = get_close_matches(name, names, n=3, cutoff=0.5)
    return f"did you mean {' or '.join(close)}?" if close else f"known are {', '.join(names)}"
