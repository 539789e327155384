"""How much memory a Parquet file takes when it is read, as its footer tells.

A few kilobytes may stand for gigabytes. The footer is a structure of Thrift's compact protocol,
`FileMetaData` of https://github.com/apache/parquet-format/blob/master/src/main/thrift/parquet.thrift.
"""

from __future__ import annotations

import struct
from typing import Any

from aerocues.expansion import why_too_large

BYTES_OF_A_VALUE = 16
MOST_COLUMNS = 200
END = 8
# Numbers of the fields that matter here.
SCHEMA, ROWS, ROW_GROUPS, GROUP_COLUMNS, COLUMN_FACTS, EXPANDED = 2, 3, 4, 1, 3, 6


def why_not_decoded(parquet: bytes) -> str | None:
    """Why a Parquet file is not to be read, or None."""
    try:
        needed = expanded_size(parquet)
    except (IndexError, KeyError, TypeError, ValueError, RecursionError, struct.error):
        return "its footer is not that of a Parquet file"
    return why_too_large(len(parquet), needed)


def expanded_size(content: bytes) -> int:
    """Bytes of all values in memory: pages without compression, and rows that pages only count."""
    footer = int.from_bytes(content[-END : -END // 2], "little")
    facts = _Compact(content[len(content) - END - footer : -END]).fields()
    pages = sum(
        column[COLUMN_FACTS][EXPANDED]
        for group in facts[ROW_GROUPS]
        for column in group[GROUP_COLUMNS]
    )
    columns = min(len(facts[SCHEMA]) - 1, MOST_COLUMNS)
    return int(pages + facts[ROWS] * columns * BYTES_OF_A_VALUE)


class _Compact:
    """Reads a structure of Thrift's compact protocol into dictionaries by number of field."""

    def __init__(self, content: bytes) -> None:
        self._content = content
        self._place = 0

    def fields(self) -> dict[int, Any]:
        """The fields of a structure, up to its end."""
        found: dict[int, Any] = {}
        number = 0
        while head := self._byte():
            number = number + (head >> 4) if head >> 4 else self._integer()
            found[number] = self._value(head & 15)
        return found

    def _value(self, kind: int) -> Any:
        if kind in (1, 2):
            return kind == 1
        if kind == 3:
            return self._byte()
        if kind in (4, 5, 6):
            return self._integer()
        if kind == 7:
            return struct.unpack("<d", self._bytes(8))[0]
        if kind == 8:
            return self._bytes(self._count())
        if kind in (9, 10):
            return self._list()
        if kind == 12:
            return self.fields()
        raise ValueError(f"no type {kind}")

    def _list(self) -> list[Any]:
        head = self._byte()
        length = head >> 4 if head >> 4 < 15 else self._count()
        kind = head & 15
        # In a list, truth values take a byte each.
        return [self._byte() if kind in (1, 2) else self._value(kind) for _ in range(length)]

    def _byte(self) -> int:
        self._place += 1
        return self._content[self._place - 1]

    def _bytes(self, length: int) -> bytes:
        self._place += length
        return self._content[self._place - length : self._place]

    def _count(self) -> int:
        """A number of 7 bits a byte, the lowest first."""
        value = shift = 0
        while True:
            byte = self._byte()
            value |= (byte & 127) << shift
            if byte < 128:
                return value
            shift += 7

    def _integer(self) -> int:
        value = self._count()
        return value >> 1 ^ -(value & 1)
