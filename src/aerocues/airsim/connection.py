"""MessagePack-RPC over TCP, as AirSim's server speaks it.

A request is ``[0, id, method, arguments]``, an answer ``[1, id, error, result]``; structures are
maps (https://github.com/msgpack-rpc/msgpack-rpc/blob/master/spec.md).
"""

from __future__ import annotations

import socket
from typing import Any

from aerocues.errors import SimulationError

_REQUEST, _ANSWER = 0, 1
_LARGEST = 2**31 - 1
_CHUNK = 1 << 16


class RefusedCallError(SimulationError):
    """The server answered with an error."""


class Connection:
    """One connection to a server.

    Parameters
    ----------
    host : str
    port : int
    timeout : float
        Seconds that an answer may take.

    Raises
    ------
    OSError
        If there is no server, or later if the connection breaks.
    SimulationError
        If the package msgpack is missing.
    """

    def __init__(self, host: str, port: int, timeout: float) -> None:
        try:
            import msgpack
        except ImportError as error:
            raise SimulationError(
                "AirSim is spoken to with msgpack; install it: pip install 'aerocues[airsim]'"
            ) from error
        self._pack = msgpack.packb
        self._socket = socket.create_connection((host, port), timeout)
        self._answers = msgpack.Unpacker(
            raw=False, unicode_errors="surrogateescape", max_buffer_size=_LARGEST
        )
        self._number = 0

    def call(self, method: str, *arguments: Any) -> Any:
        """Call a method and wait for its result.

        Raises
        ------
        RefusedCallError
            If the server answers with an error.
        OSError
            If the connection is lost, or no answer comes in time.
        """
        self._number += 1
        self._socket.sendall(self._pack([_REQUEST, self._number, method, list(arguments)]))
        kind, number, error, result = self._receive()
        if kind != _ANSWER or number != self._number:
            raise ConnectionError("the server answers something else than was asked")
        if error is not None:
            raise RefusedCallError(f"the simulator refuses {method}: {_text(error)}")
        return result

    def _receive(self) -> Any:
        while True:
            for answer in self._answers:
                if not isinstance(answer, list) or len(answer) != 4:
                    raise ConnectionError("what answers there does not speak MessagePack-RPC")
                return answer
            received = self._socket.recv(_CHUNK)
            if not received:
                raise ConnectionError("the server closed the connection")
            self._answers.feed(received)

    def close(self) -> None:
        """End the connection."""
        self._socket.close()


def as_bytes(data: Any) -> bytes:
    """Bytes of an answer, which older servers send as text."""
    return data.encode("utf-8", "surrogateescape") if isinstance(data, str) else bytes(data)


def _text(error: Any) -> str:
    """The first line of what a server complains of."""
    lines = str(error).strip().splitlines()
    return lines[0] if lines else "no reason given"
