"""Changes of bytes as disks, networks, editors and attackers make them; seeded."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator

Change = Callable[[bytearray, random.Random], bytearray]
EXTREMES = (
    b"0",
    b"-1",
    b"1e999",
    b"NaN",
    b"-Infinity",
    b"9" * 400,
    b"null",
    b"true",
    b'"no"',
    b"[]",
    b"{}",
    b"[" * 2000,
    b"\0",
    b"\xff\xfe",
    b"\xef\xbb\xbf",
    b"\r",
    b"\n\n",
    b";",
    b",,",
    b'"',
    "\u202e\U0001f600".encode(),
    b"..\\..\\x",
    b"=1+1",
)


def flip(content: bytearray, chance: random.Random) -> bytearray:
    """One to four bits."""
    for _ in range(chance.randint(1, 4)):
        content[chance.randrange(len(content))] ^= 1 << chance.randrange(8)
    return content


def cut(content: bytearray, chance: random.Random) -> bytearray:
    return content[: chance.randrange(len(content))]


def leave_out(content: bytearray, chance: random.Random) -> bytearray:
    start = chance.randrange(len(content))
    del content[start : start + chance.randint(1, 1 + len(content) // 4)]
    return content


def repeat(content: bytearray, chance: random.Random) -> bytearray:
    start = chance.randrange(len(content))
    piece = content[start : start + chance.randint(1, 64)]
    content[start:start] = piece * chance.choice((1, 2, 50))
    return content


def zeros(content: bytearray, chance: random.Random) -> bytearray:
    start = chance.randrange(len(content))
    piece = content[start : start + chance.choice((1, 16, 512, 4096))]
    content[start : start + len(piece)] = bytes(len(piece))
    return content


def insert(content: bytearray, chance: random.Random) -> bytearray:
    place = chance.randrange(len(content) + 1)
    content[place:place] = chance.choice(EXTREMES)
    return content


def replace_word(content: bytearray, chance: random.Random) -> bytearray:
    """A number or a word between separators becomes something extreme."""
    words = [word for word in content.replace(b",", b" ").replace(b":", b" ").split() if word]
    if words:
        word = chance.choice(words).strip(b"\"'[]{}")
        place = content.find(word)
        if word and place >= 0:
            content[place : place + len(word)] = chance.choice(EXTREMES)
    return content


CHANGES: tuple[Change, ...] = (flip, cut, leave_out, repeat, zeros, insert, replace_word)


def mutated(content: bytes, count: int, seed: str) -> Iterator[bytes]:
    """So many changed contents: one change each, sometimes a second one."""
    chance = random.Random(seed)
    for number in range(count):
        changed = CHANGES[number % len(CHANGES)](bytearray(content), chance)
        if changed and chance.random() < 0.3:
            changed = chance.choice(CHANGES)(changed, chance)
        yield bytes(changed)
