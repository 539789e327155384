"""The page of a results folder on this machine while a command fills it.

A thread makes the page anew from the rows that are there, seldom enough to leave the cores to the
work; the page asks for the state every few seconds and loads itself again when there is a new one.
"""

from __future__ import annotations

import html
import json
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from aerocues.errors import AerocuesError
from aerocues.progress import Event

HOST = "127.0.0.1"
SECONDS_BETWEEN_PAGES = 5.0
# Making a page takes at most this share of a core.
SHARE_OF_TIME = 0.1
RESAMPLES = 200
# While calls are timed one at a time, nothing else may use a core.
TIMED_ALONE = "timing"
CLOSED = "default-src 'none';"
OPEN_TO_ITSELF = "default-src 'none'; connect-src 'self';"
FOLLOW = """
<div id="live" role="status" style="position:sticky;bottom:0;padding:.5rem 1rem;
font:14px sans-serif;background:#14324a;color:#fff;z-index:9">live</div>
<script>(() => {
  const line = document.getElementById("live"), made = %(made)d;
  let touched = 0;
  for (const kind of ["pointerdown", "keydown", "wheel"]) {
    addEventListener(kind, () => { touched = Date.now(); }, {passive: true});
  }
  const ask = async () => {
    try {
      const state = await (await fetch("state")).json();
      // Whoever is reading is not disturbed.
      const ready = state.made !== made && Date.now() - touched > 15000;
      if (ready) { location.reload(); return; }
      line.textContent = state.told;
      setTimeout(ask, 2000);
    } catch {
      line.textContent = "The command has ended: this is the page as it was last. "
        + "'aerocues report' writes the whole one.";
    }
  };
  ask();
})();</script>
</body>"""
WAITING = """<!doctype html><html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; \
script-src 'unsafe-inline'"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>aerocues</title><link rel="icon" href="data:,"></head>
<body style="font:16px sans-serif;margin:2rem"><h1>aerocues</h1><p>%s</p></body></html>"""


@dataclass
class LivePage:
    """Serves the page of a results folder; called with the events of the work.

    Parameters
    ----------
    folder : Path
        Results folder; it need not exist yet.
    make : callable
        Makes the page of a folder: HTML.
    clock, used : callable
        Return seconds, and CPU seconds of the process: a page takes more threads than one.
    tell : callable, optional
        How things stand, in a line; the latest event by default.

    Attributes
    ----------
    made : int
        How many pages were made so far.
    """

    folder: Path
    make: Callable[[Path], str]
    clock: Callable[[], float] = time.monotonic
    used: Callable[[], float] = time.process_time
    tell: Callable[[], str] | None = None
    event: Event = field(default_factory=lambda: Event("starting"))
    made: int = 0
    changes: int = 0
    page: str = WAITING % "There are no rows yet that can be ranked."
    _made_of: int = 0
    _next: float = float("-inf")
    _making: threading.Lock = field(default_factory=threading.Lock)

    def __call__(self, event: Event) -> None:
        """Take in an event; before calls are timed alone, wait for a page that is being made."""
        begins = event.stage != self.event.stage
        self.changes += bool(event.rows) or event.done != self.event.done
        self.event = event
        if begins and event.stage == TIMED_ALONE:
            with self._making:
                pass

    def refresh(self) -> bool:
        """Make the page anew where there are new rows and it is time; whether that was done."""
        with self._making:
            return self._refresh()

    def _refresh(self) -> bool:
        now, begun = self.clock(), self.used()
        if now < self._next or self.changes == self._made_of or self.event.stage == TIMED_ALONE:
            return False
        self._made_of = self.changes
        try:
            self.page = self.make(self.folder)
        except AerocuesError as error:  # too few rows to rank so far
            self.page = WAITING % html.escape(str(error)) if not self.made else self.page
        else:
            self.made += 1
        used = self.used() - begun
        self._next = self.clock() + max(SECONDS_BETWEEN_PAGES, used / SHARE_OF_TIME)
        return True

    def state(self) -> dict[str, Any]:
        """What the page asks for."""
        return {"made": self.made, "told": self.tell() if self.tell else str(self.event)}

    def html(self) -> str:
        """The page, which asks this server and nobody else how things stand."""
        opened = self.page.replace(CLOSED, OPEN_TO_ITSELF, 1)
        before, _, after = opened.rpartition("</body>")
        return f"{before}{FOLLOW % {'made': self.made}}{after}"


def page_of_folder(folder: Path) -> str:
    """The page of what a folder holds so far, without pictures, clouds and the answer of a race.

    While a race goes on, the recorded answer is that of another race, or there is none.

    Raises
    ------
    AerocuesError
        If there are too few rows to rank.
    """
    from aerocues.report.page import page_of
    from aerocues.report.payload import payload_of
    from aerocues.report.report import default_title, listed, report_entries

    entries = report_entries(listed(folder), resamples=RESAMPLES)
    payload = payload_of(entries, f"{default_title(entries)}, so far")
    for entry in payload["entries"]:
        entry["race"] = None
    return page_of(payload)


class _Handler(BaseHTTPRequestHandler):
    server: _Server

    def do_GET(self) -> None:
        """Answer the two addresses; others, and those who came by another name, get nothing."""
        live = self.server.live
        if self.headers.get("Host") != self.server.host:
            self._answer(403, "text/plain", "only as " + self.server.host)
        elif self.path == "/":
            self._answer(200, "text/html", live.html())
        elif self.path == "/state":
            self._answer(200, "application/json", json.dumps(live.state()))
        else:
            self._answer(404, "text/plain", "not found")

    def _answer(self, code: int, kind: str, text: str) -> None:
        content = text.encode()
        self.send_response(code)
        self.send_header("Content-Type", f"{kind}; charset=utf-8")
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_: Any) -> None:
        """Requests are not told: standard error belongs to the command."""


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, live: LivePage) -> None:
        super().__init__((HOST, 0), _Handler)
        self.live = live
        self.host = f"{HOST}:{self.server_port}"

    def handle_error(self, *_: Any) -> None:
        """A browser that closes a connection is no error of the command."""


class Serving:
    """Serves a live page until the block ends.

    Parameters
    ----------
    live : LivePage
    """

    def __init__(self, live: LivePage) -> None:
        self._live, self._over = live, threading.Event()
        self._server = _Server(live)
        self.address = f"http://{self._server.host}/"
        self._threads = [
            threading.Thread(target=self._server.serve_forever, daemon=True),
            threading.Thread(target=self._refresh, daemon=True),
        ]

    def _refresh(self) -> None:
        while not self._over.wait(1.0):
            self._live.refresh()

    def __enter__(self) -> Serving:
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._server.shutdown()
        self._server.server_close()
        for thread in self._threads:
            thread.join()
