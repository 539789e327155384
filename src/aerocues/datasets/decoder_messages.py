"""What the decoders in OpenCV write to the standard error, where they have no other way to tell."""

from __future__ import annotations

import os
import re
import tempfile
import threading
from collections.abc import Callable
from contextlib import ExitStack
from typing import TypeVar

STANDARD_ERROR = 2
_Result = TypeVar("_Result")
# The descriptor belongs to the whole process.
_lock = threading.Lock()
_FROM_DECODERS = re.compile(
    rb"(Corrupt JPEG|Premature end|Inconsistent progression|Invalid SOS|Unsupported marker|libpng"
    rb"|Warning: unknown JFIF|\[ ?[A-Z]+:\d+@|> |where|$)"
)


def with_messages(decode: Callable[[], _Result]) -> tuple[_Result, bytes]:
    """Decode an image, and return what was written to the standard error meanwhile.

    What is not of a decoder, such as a progress bar of another thread, is written afterwards.
    """
    with _lock, ExitStack() as opened:
        try:
            file = opened.enter_context(tempfile.TemporaryFile())
            before = os.dup(STANDARD_ERROR)
        except OSError:  # no room for the file; or nobody can write there
            return decode(), b""
        os.dup2(file.fileno(), STANDARD_ERROR)
        try:
            result = decode()
        finally:
            os.dup2(before, STANDARD_ERROR)
            os.close(before)
        file.seek(0)
        written = file.read()
    _pass_on(written)
    return result, written


def _pass_on(written: bytes) -> None:
    others = [line for line in written.splitlines(keepends=True) if not _FROM_DECODERS.match(line)]
    if others:
        os.write(STANDARD_ERROR, b"".join(others))
