"""How messages write numbers of things, spans of time and text that is none."""

from __future__ import annotations

import unicodedata

# Control characters, halves of characters, and marks that turn the direction of what follows.
_ESCAPED_KINDS = ("Cc", "Cs", "Zl", "Zp")
_DIRECTIONS = frozenset("\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
_BYTES = 0xDC00
"""Python's names of files have bytes that are not Unicode as characters from here on."""


def count(number: int, noun: str, plural: str | None = None) -> str:
    """``1 row``, ``1,234 rows``."""
    return f"{number:,} {noun if number == 1 else plural or noun + 's'}"


def number_text(value: float, digits: int) -> str:
    """A number with so many digits after the point, or ``-`` where it is not known."""
    return "-" if value != value else f"{value:.{digits}f}"


def likelihood(probability: float) -> str:
    """``61%``; never 0% nor 100%, as what comes from draws is never certain."""
    rounded = f"{probability:.0%}"
    return {"0%": "<1%", "100%": ">99%"}.get(rounded, rounded)


def spoken_seconds(seconds: float) -> str:
    """``8 s``, ``4 min 05 s``, ``2 h 10 min``."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"


def printable(text: str) -> str:
    r"""A text to store and print: what is not Unicode or controls a terminal is escaped.

    ``fl\xfcg.jpg`` for a name in Latin-1; all other texts are returned as they are.
    """
    return text if text.isprintable() else "".join(map(_escaped, text))


def _escaped(character: str) -> str:
    if character not in _DIRECTIONS and unicodedata.category(character) not in _ESCAPED_KINDS:
        return character
    code = ord(character)
    if 0x80 <= code - _BYTES <= 0xFF:
        return f"\\x{code - _BYTES:02x}"
    return character.encode("unicode_escape", "surrogatepass").decode("ascii")
