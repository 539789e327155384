"""A page of memory that a worker shares with its parent: which stage call it is in.

It outlives the worker, costs microseconds a call and wakes nobody up.
"""

from __future__ import annotations

import json
import mmap
import struct
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from aerocues.processes.call import StageCall

SIZE = 4096
HEADER = struct.Struct("<QQddI")


@dataclass(frozen=True)
class Beat:
    """The latest announcement: its number, the process's CPU seconds and the wall time then."""

    number: int
    cpu_seconds: float
    wall_time: float
    call: StageCall | None


class Heartbeat:
    """One writer (the worker) and one reader (its parent) over a mapped file of one page."""

    def __init__(self, path: Path) -> None:
        with path.open("r+b") as file:
            file.truncate(SIZE)
            self._page = mmap.mmap(file.fileno(), SIZE)
        self._number = 0

    def announce(self, call: StageCall | None) -> None:
        """Say which call comes next; None between units."""
        self._number += 1
        text = b"" if call is None else json.dumps(asdict(call)).encode()[: SIZE - HEADER.size]
        # The second number, written last, tells the reader that the page is whole.
        self._page[:8] = struct.pack("<Q", self._number)
        self._page[HEADER.size : HEADER.size + len(text)] = text
        self._page[16 : HEADER.size] = struct.pack(
            "<ddI", time.process_time(), time.monotonic(), len(text)
        )
        self._page[8:16] = struct.pack("<Q", self._number)

    def read(self) -> Beat | None:
        """The latest announcement, or None while it is being written."""
        first, last, cpu, wall, length = HEADER.unpack(self._page[: HEADER.size])
        text = self._page[HEADER.size : HEADER.size + length]
        if first != last or HEADER.unpack(self._page[: HEADER.size])[0] != last:
            return None
        try:
            call = StageCall(**json.loads(text)) if length else None
        except ValueError:
            # Cut to the page's size: names of images can be thousands of characters long.
            call = None
        return Beat(last, cpu, wall, call)

    def close(self) -> None:
        self._page.close()
