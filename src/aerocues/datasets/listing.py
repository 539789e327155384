"""Which files of a folder are its images, and what is left out."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from aerocues.datasets.header import SUFFIXES
from aerocues.datasets.heic import INSTALL, can_read_heic
from aerocues.datasets.heic import SUFFIXES as HEIC_SUFFIXES
from aerocues.errors import DatasetError
from aerocues.phrases import count, printable

HIDDEN = "hidden"
THUMBNAILS = "thumbnails"
OWN_OUTPUT = "output of aerocues"
BROKEN_LINKS = "broken links"
SEEN_TWICE = "the same by a link"

VIDEO_SUFFIXES = frozenset({".mp4", ".mov", ".avi", ".mkv", ".mts", ".m4v"})
OTHERS: tuple[tuple[str, str, frozenset[str]], ...] = (
    ("HEIC", INSTALL, HEIC_SUFFIXES),
    (
        "raw",
        "export them as TIFF or JPEG",
        frozenset({".dng", ".cr2", ".cr3", ".nef", ".arw", ".raf", ".rw2", ".orf", ".srw"}),
    ),
    ("video", "save frames of them as images", VIDEO_SUFFIXES),
    (
        "AVIF, JPEG 2000 or GIF",
        "convert them to PNG",
        frozenset({".avif", ".jp2", ".j2k", ".jxl", ".gif"}),
    ),
)
"""Kinds of files that may be meant, what to do with them, and their suffixes."""

_THUMBNAIL_FOLDERS = frozenset({"@eadir", "thumbnails", "thumbs", "__macosx", "#recycle"})
_BESIDE_THM = "misc"
_MARKS = ("run.json", "reconstruction.json")
_OWN_FOLDERS = re.compile(r"images|features|parts|clouds|references|[^-]+-[^-]+-[^-]+-[^-]+")
MOST_NAMED = 3


@dataclass(frozen=True)
class Listing:
    """The images of a folder.

    Parameters
    ----------
    images : tuple of Path
        In natural order.
    left_out : mapping of str to tuple of str
        Files and folders that may be expected among them, by the reason.
    """

    images: tuple[Path, ...]
    left_out: Mapping[str, tuple[str, ...]]

    def told(self) -> list[str]:
        """What is left out, such as ``2 HEIC files (a.HEIC, b.HEIC): convert them to JPEG``."""
        advice = {kind: what for kind, what, _ in OTHERS}
        told = []
        for reason, names in self.left_out.items():
            if reason == HIDDEN:
                told.append(count(len(names), "hidden file"))
                continue
            shown = ", ".join(names[:MOST_NAMED]) + (", ..." if len(names) > MOST_NAMED else "")
            if reason in advice:
                told.append(f"{count(len(names), f'{reason} file')} ({shown}): {advice[reason]}")
            else:
                told.append(f"{reason} ({shown})")
        return told


def natural_key(name: str) -> tuple[tuple[int, int, str], ...]:
    """Sort key that puts ``img2`` before ``img10``, ignoring case."""
    parts = re.split(r"([0-9]+)", name.casefold())
    keyed = ((i % 2, int(part) if i % 2 else 0, part) for i, part in enumerate(parts))
    return (*keyed, (0, 0, name))


def is_own_output(folder: Path) -> bool:
    """Whether a folder has results or models of aerocues."""
    return any((folder / mark).is_file() for mark in _MARKS)


def has_thumbnails(folder: Path) -> bool:
    """Whether a folder is one in which cameras and servers keep small copies."""
    name, above = folder.name.casefold(), folder.parent.name.casefold()
    return name in _THUMBNAIL_FOLDERS or (name == "thm" and above == _BESIDE_THM)


def list_images(folder: Path, *, tree: bool = False) -> Listing:
    """The image files of a folder, or of all folders below it, by their suffix.

    Links to folders are followed. Hidden files, thumbnails that cameras and servers keep, and
    results of aerocues are left out.

    Raises
    ------
    DatasetError
        If the folder cannot be read.
    """
    return _Search(folder, tree=tree).listing()


class _Search:
    def __init__(self, folder: Path, *, tree: bool) -> None:
        self._root = folder
        self._tree = tree
        self._images: dict[str, Path] = {}
        self._left_out: dict[str, list[str]] = {}
        self._seen: set[str] = set()
        self._suffixes = SUFFIXES | (HEIC_SUFFIXES if can_read_heic() else frozenset())

    def listing(self) -> Listing:
        self._look_into(self._root)
        found = sorted(self._images.items(), key=lambda item: natural_key(item[0]))
        left_out = {
            reason: tuple(printable(name) for name in sorted(names, key=natural_key))
            for reason, names in self._left_out.items()
        }
        return Listing(tuple(path for _, path in found), left_out)

    def _look_into(self, folder: Path) -> None:
        real = os.path.realpath(folder)
        if real in self._seen:
            return self._leave_out(SEEN_TWICE, folder)
        self._seen.add(real)
        entries = sorted(self._entries(folder), key=lambda path: natural_key(path.name))
        own = {path.name for path in entries}.intersection(_MARKS)
        if own and folder != self._root:
            return self._leave_out(OWN_OUTPUT, folder)
        for path in entries:
            if path.name.startswith("."):
                self._hidden(path)
            elif path.is_dir():
                if self._tree:
                    self._consider(path, inside_own=bool(own))
            else:
                self._file(path)
        return None

    def _entries(self, folder: Path) -> Iterator[Path]:
        try:
            yield from folder.iterdir()
        except OSError as error:
            raise DatasetError(
                f"cannot read the folder {printable(str(folder))}: {error.strerror}; check its path"
            ) from error

    def _consider(self, folder: Path, *, inside_own: bool) -> None:
        if has_thumbnails(folder):
            self._leave_out(THUMBNAILS, folder)
        elif inside_own and _OWN_FOLDERS.fullmatch(folder.name):
            self._leave_out(OWN_OUTPUT, folder)
        else:
            self._look_into(folder)

    def _hidden(self, path: Path) -> None:
        if path.suffix.lower() in SUFFIXES:
            self._leave_out(HIDDEN, path)

    def _file(self, path: Path) -> None:
        suffix = path.suffix.lower()
        if suffix in self._suffixes:
            if path.is_file():
                self._images[path.relative_to(self._root).as_posix()] = path
            elif path.is_symlink():
                self._leave_out(BROKEN_LINKS, path)
            return
        kind = next((kind for kind, _, suffixes in OTHERS if suffix in suffixes), None)
        if kind is not None:
            self._leave_out(kind, path)

    def _leave_out(self, reason: str, path: Path) -> None:
        self._left_out.setdefault(reason, []).append(path.relative_to(self._root).as_posix())
