"""Standard error is where it was, whatever comes between."""

from __future__ import annotations

import os
import signal
import tempfile
import threading
from pathlib import Path

import pytest

from aerocues.standard_error import STANDARD_ERROR, standard_error_in, tell


def where() -> tuple[int, int]:
    """The file behind standard error."""
    found = os.fstat(STANDARD_ERROR)
    return found.st_dev, found.st_ino


def test_what_is_written_meanwhile_is_in_the_file(tmp_path: Path) -> None:
    before = where()
    with (tmp_path / "told").open("wb") as file, standard_error_in(file):
        os.write(STANDARD_ERROR, b"a word of a library\n")
    assert (tmp_path / "told").read_text() == "a word of a library\n"
    assert where() == before


def test_an_interruption_comes_afterwards() -> None:
    """Also where a library raises an exception of its own for the same signal, as polars does."""
    before = where()

    def interrupted() -> None:
        with tempfile.TemporaryFile() as file, standard_error_in(file):
            signal.raise_signal(signal.SIGINT)
            raise KeyboardInterrupt("of the library")

    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt, match=r"^$"):
            interrupted()
        assert where() == before
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, handler)


def test_what_is_told_meanwhile_comes_afterwards(capfd: pytest.CaptureFixture[str]) -> None:
    """Not into the file of another thread, where nobody would read it."""
    led, over = threading.Event(), threading.Event()

    def lead() -> None:
        with tempfile.TemporaryFile() as file, standard_error_in(file):
            led.set()
            over.wait()

    other = threading.Thread(target=lead)
    other.start()
    led.wait()
    teller = threading.Thread(target=tell, args=["interrupted\n"])
    teller.start()
    over.set()
    other.join()
    teller.join()
    assert capfd.readouterr().err == "interrupted\n"


def test_threads_wait_for_each_other() -> None:
    before = where()

    def often() -> None:
        for _ in range(50):
            with tempfile.TemporaryFile() as file, standard_error_in(file):
                os.write(STANDARD_ERROR, b".")

    threads = [threading.Thread(target=often) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert where() == before
