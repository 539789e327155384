"""Downloads one file over HTTP: resumes, retries and reports progress."""

from __future__ import annotations

import http.client
import time
import urllib.error
import urllib.request
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from aerocues.errors import DatasetError

Progress = Callable[[str, int, int | None], None]
"""Called with the file's name, the bytes so far, and the total bytes (None: unknown)."""

_BLOCK = 1 << 18
_NOTHING_LEFT = 416
_PARTIAL = 206


class DownloadError(DatasetError):
    """A file could not be downloaded; the next attempt continues from the part received."""


@dataclass(frozen=True)
class Downloader:
    """A downloader as pooch calls it, for one file.

    Parameters
    ----------
    part : Path
        Partial file; it is kept when the transfer is interrupted. Its validator (ETag or date) is
        stored next to it, so that two versions of a file are never joined.
    progress : Progress or None
        Called after every block.
    attempts : int
        Number of attempts when the connection fails; a refusal by the server (404) is final.
    pause : float
        Seconds before the second attempt, doubled before each further one.
    timeout : float
        Seconds without data after which the connection counts as broken.
    """

    part: Path
    progress: Progress | None = None
    attempts: int = 4
    pause: float = 1.0
    timeout: float = 30.0

    def __call__(self, url: str, output_file: str | Path, pooch: object) -> None:
        """Download `url` to `output_file`; DownloadError if that fails."""
        reason: Exception | None = None
        for attempt in range(self.attempts):
            if attempt:
                time.sleep(self.pause * 2 ** (attempt - 1))
            try:
                self._resume(url)
            except urllib.error.HTTPError as error:
                reason = error
                if error.code < 500 and error.code not in (408, 429):
                    break
            except (OSError, http.client.HTTPException) as error:
                reason = error
            else:
                self.part.replace(output_file)
                self._validator.unlink(missing_ok=True)
                return
        raise DownloadError(f"cannot download {url}: {_words(reason)}") from reason

    @property
    def _validator(self) -> Path:
        return self.part.with_name(self.part.name + ".validator")

    def _resume(self, url: str) -> None:
        start = self._bytes_there()
        try:
            self._transfer(url, start)
        except urllib.error.HTTPError as error:
            if error.code != _NOTHING_LEFT:
                raise
            self.part.unlink(missing_ok=True)
            self._transfer(url, 0)

    def _bytes_there(self) -> int:
        return self.part.stat().st_size if self.part.exists() and self._validator.exists() else 0

    def _transfer(self, url: str, start: int) -> None:
        request = urllib.request.Request(url, headers={"User-Agent": "aerocues"})
        if start:
            request.add_header("Range", f"bytes={start}-")
            request.add_header("If-Range", self._validator.read_text(encoding="ascii"))
        with urllib.request.urlopen(request, timeout=self.timeout) as answer:
            if answer.status != _PARTIAL:
                start = 0
            self._remember(answer.headers.get("ETag") or answer.headers.get("Last-Modified"))
            length = answer.headers.get("Content-Length")
            total = start + int(length) if length is not None else None
            with self.part.open("ab" if start else "wb") as file:
                there = self._copy(answer, file, start, total)
        if total is not None and there < total:
            raise http.client.IncompleteRead(b"", total - there)

    def _remember(self, validator: str | None) -> None:
        # A weak validator does not guarantee equal bytes: the next attempt then starts over.
        if validator is None or validator.startswith("W/"):
            self._validator.unlink(missing_ok=True)
        else:
            self._validator.write_text(validator, encoding="ascii")

    def _copy(
        self, answer: http.client.HTTPResponse, file: IO[bytes], there: int, total: int | None
    ) -> int:
        while block := answer.read(_BLOCK):
            file.write(block)
            there += len(block)
            if self.progress is not None:
                self.progress(self.part.name.removesuffix(".part"), there, total)
        return there


def _words(reason: Exception | None) -> str:
    if isinstance(reason, urllib.error.HTTPError):
        return f"the server answers {reason.code} {reason.reason}"
    if isinstance(reason, urllib.error.URLError):
        return str(reason.reason)
    if isinstance(reason, http.client.IncompleteRead):
        return "the connection was interrupted"
    return str(reason) or type(reason).__name__
