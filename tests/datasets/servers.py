"""A web server on this machine that knows ranges, breaks off when told to, and keeps a log."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer


@dataclass
class Site:
    """What the server serves and how.

    Parameters
    ----------
    files : dict
        Content by name.
    break_after : list of int
        For the next answers, one each: how many bytes to send before the connection breaks.
    failures : list of int
        Statuses of the next answers.
    etag : str or None
        Sent with every file.
    log : list
        Name and Range header of every request.
    """

    files: dict[str, bytes]
    break_after: list[int] = field(default_factory=list)
    failures: list[int] = field(default_factory=list)
    etag: str | None = '"first"'
    log: list[tuple[str, str | None]] = field(default_factory=list)


class _Handler(BaseHTTPRequestHandler):
    site: Site

    def do_GET(self) -> None:
        site, name = self.site, self.path.strip("/")
        wanted = self.headers.get("Range")
        site.log.append((name, wanted))
        if site.failures:
            self.send_error(site.failures.pop(0))
        elif name not in site.files:
            self.send_error(404)
        else:
            self._send(site.files[name], wanted)

    def _send(self, content: bytes, wanted: str | None) -> None:
        start = 0
        match = re.fullmatch(r"bytes=(\d+)-", wanted or "")
        if match and self.headers.get("If-Range") == self.site.etag:
            start = int(match[1])
        if start >= len(content):
            self.send_error(416)
            return
        self.send_response(206 if start else 200)
        if start:
            self.send_header("Content-Range", f"bytes {start}-{len(content) - 1}/{len(content)}")
        self.send_header("Content-Length", str(len(content) - start))
        if self.site.etag is not None:
            self.send_header("ETag", self.site.etag)
        self.end_headers()
        body = content[start:]
        if self.site.break_after:
            body = body[: self.site.break_after.pop(0)]
        self.wfile.write(body)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002
        """Print nothing."""


def serve(site: Site) -> ThreadingHTTPServer:
    """A server of a site on a free port; the caller runs and closes it."""
    handler = type("Handler", (_Handler,), {"site": site})
    return ThreadingHTTPServer(("127.0.0.1", 0), handler)
