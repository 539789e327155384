"""What the decoders in OpenCV write to the standard error, where they have no other way to tell."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Callable
from contextlib import ExitStack
from typing import TypeVar

from aerocues.standard_error import STANDARD_ERROR, standard_error_in

_Result = TypeVar("_Result")
_FROM_DECODERS = re.compile(
    rb"(Corrupt JPEG|Premature end|Inconsistent progression|Invalid SOS|Unsupported marker|libpng"
    rb"|Warning: unknown JFIF|\[ ?[A-Z]+:\d+@|> |where|$)"
)


def with_messages(decode: Callable[[], _Result]) -> tuple[_Result, bytes]:
    """Decode an image, and return what was written to the standard error meanwhile.

    What is not of a decoder, such as a progress bar of another thread, is written afterwards.
    """
    with ExitStack() as opened:
        try:
            file = opened.enter_context(tempfile.TemporaryFile())
        except OSError:  # no room for it
            return decode(), b""
        with standard_error_in(file):
            result = decode()
        file.seek(0)
        written = file.read()
    _pass_on(written)
    return result, written


def _pass_on(written: bytes) -> None:
    others = [line for line in written.splitlines(keepends=True) if not _FROM_DECODERS.match(line)]
    if others:
        os.write(STANDARD_ERROR, b"".join(others))
