"""Connects to a Dask scheduler."""

from __future__ import annotations

import contextlib
import logging
import socket
from collections.abc import Iterator
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from aerocues.errors import EngineError

if TYPE_CHECKING:
    from distributed import Client

CONNECT_SECONDS = 10.0


@contextlib.contextmanager
def connected(scheduler: str) -> Iterator[Client]:
    """A client of the Dask scheduler at an address such as ``tcp://host:8786``.

    Raises
    ------
    EngineError
        If no scheduler answers, or ``distributed`` is not installed.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise EngineError(
            f"a Dask cluster needs a package that is not installed ({error}); "
            "pip install 'aerocues[dask]'"
        ) from error
    try:
        _knock(scheduler)
        client = Client(scheduler, timeout=CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError) as error:
        raise EngineError(
            f"no Dask scheduler answers at {scheduler}; start one with 'dask scheduler' and give "
            'the address that it prints, such as `scheduler="tcp://HOST:8786"`'
        ) from error
    with client, _quiet():
        yield client


def _knock(scheduler: str) -> None:
    """Check quickly whether anything listens at an address; a client would wait for long.

    Raises
    ------
    OSError, ValueError
        If nothing does, or the address is invalid.
    """
    parts = urlsplit(scheduler if "://" in scheduler else f"tcp://{scheduler}")
    if parts.scheme not in ("tcp", "tls") or not parts.hostname or not parts.port:
        raise ValueError(scheduler)
    socket.create_connection((parts.hostname, parts.port), CONNECT_SECONDS).close()


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Stop the client from logging errors that we report ourselves."""
    logger = logging.getLogger("distributed.client")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(level)
