"""Downloads the public benchmarks from their authors' addresses."""

from __future__ import annotations

import importlib
import json
import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aerocues.datasets.downloading import Downloader, DownloadError, Progress
from aerocues.datasets.unpacking import unpack_sequences
from aerocues.errors import DatasetError, MethodUnavailableError

CHECKSUMS = "checksums.json"


@dataclass(frozen=True)
class Location:
    """An address of an archive, with its SHA-256 if known.

    If it is unknown, the first download is trusted and its hash recorded in `CHECKSUMS`; later
    downloads into the same folder must have the same hash.
    """

    url: str
    sha256: str | None = None

    @property
    def file(self) -> str:
        """Name of the file."""
        return self.url.rpartition("/")[2]


@dataclass(frozen=True)
class Archive:
    """One archive of a benchmark and the addresses to try, in order."""

    sequence: str
    locations: tuple[Location, ...]


@dataclass(frozen=True)
class Benchmark:
    """A benchmark that can be downloaded.

    Parameters
    ----------
    name : str
        Name in the catalog.
    archives : tuple of Archive
        Files to download.
    marker : str
        A file in the folder of each sequence.
    layout : str
        The resulting files, for users who place them by hand.
    """

    name: str
    archives: tuple[Archive, ...]
    marker: str
    layout: str


_OXFORD_ADDRESS = "https://www.robots.ox.ac.uk/~vgg/research/affine/det_eval_files/"
_HPATCHES_ADDRESSES = (
    "http://icvl.ee.ic.ac.uk/vbalnt/hpatches/hpatches-sequences-release.tar.gz",
    "https://huggingface.co/datasets/vbalnt/hpatches/resolve/main/hpatches-sequences-release.zip",
)
BENCHMARKS = {
    "oxford": Benchmark(
        "oxford",
        tuple(
            Archive(name, (Location(f"{_OXFORD_ADDRESS}{name}.tar.gz"),))
            for name in ("bark", "bikes", "boat", "graf", "leuven", "trees", "ubc", "wall")
        ),
        "H1to2p",
        "graf/img1.ppm ... graf/img6.ppm and graf/H1to2p ... graf/H1to6p",
    ),
    "hpatches": Benchmark(
        "hpatches",
        (Archive("hpatches", tuple(Location(url) for url in _HPATCHES_ADDRESSES)),),
        "H_1_2",
        "v_churchill/1.ppm ... v_churchill/6.ppm and v_churchill/H_1_2 ... v_churchill/H_1_6",
    ),
}


def fetch(
    name: str,
    to: str | Path,
    *,
    base_url: str | None = None,
    progress: Progress | None = None,
    attempts: int = 4,
    pause: float = 1.0,
) -> list[Path]:
    """Download a benchmark and unpack it, so that ``open_dataset(f"{name}:{to}")`` opens it.

    Existing sequences are not downloaded again, and an interrupted download continues. An archive
    in `to` with its original name is used in place of a download.

    Parameters
    ----------
    name : str
        A key of `BENCHMARKS`.
    to : path
        Folder, created if missing.
    base_url : str, optional
        URL of a mirror with the archives under their original names.
    progress : callable, optional
        Called with the file's name, the bytes so far, and the total bytes (None: unknown).
    attempts, pause : int, float
        Attempts when a connection fails; seconds before the second attempt (then doubled).

    Returns
    -------
    list of Path
        Folders of the sequences.

    Raises
    ------
    DatasetError
        If the benchmark is unknown, the folder cannot be written, a checksum is wrong, an archive
        is damaged, or the download failed: then the message says which files to place where.
    MethodUnavailableError
        If pooch is not installed.
    """
    if name not in BENCHMARKS:
        raise DatasetError(f"there is no benchmark {name!r}; choose from {', '.join(BENCHMARKS)}")
    if base_url is not None and not base_url.startswith(("http://", "https://")):
        raise DatasetError(f"{base_url} is not a web address; give one that begins with https://")
    benchmark, folder = BENCHMARKS[name], Path(to).expanduser()
    _load_pooch()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        record = _Record.load(folder)
        folders: list[Path] = []
        for archive in benchmark.archives:
            sequences = record.unpacked(archive)
            if sequences is None:
                placed = any((folder / location.file).exists() for location in archive.locations)
                file = _download(benchmark, archive, record, (base_url, progress, attempts, pause))
                sequences = unpack_sequences(file, folder, benchmark.marker, archive.sequence)
                record.note_sequences(archive, sequences)
                if not placed:
                    file.unlink()
            folders += [folder / sequence for sequence in sequences]
    except OSError as error:
        raise DatasetError(
            f"cannot write to {folder}: {error.strerror}; check permissions and free space"
        ) from error
    return folders


def _load_pooch() -> Any:
    try:
        return importlib.import_module("pooch")
    except ImportError as error:
        raise MethodUnavailableError(
            "fetching needs pooch; install it: pip install 'aerocues[fetch]'"
        ) from error


@dataclass(frozen=True)
class _Record:
    """The file `CHECKSUMS`: hashes of the archives, and the sequences in each."""

    folder: Path
    hashes: dict[str, str]
    sequences: dict[str, list[str]]

    @classmethod
    def load(cls, folder: Path) -> _Record:
        file = folder / CHECKSUMS
        if not file.exists():
            return cls(folder, {}, {})
        try:
            content = json.loads(file.read_text(encoding="utf-8"))
            return cls(folder, dict(content["sha256"]), dict(content["sequences"]))
        except (ValueError, KeyError, TypeError) as error:
            raise DatasetError(f"{file} is damaged; remove it and fetch again") from error

    def unpacked(self, archive: Archive) -> list[str] | None:
        """The sequences of an archive, if all of them exist."""
        names = self.sequences.get(archive.sequence)
        if names is None or not all((self.folder / name).is_dir() for name in names):
            return None
        return names

    def note_hash(self, file: str, digest: str) -> None:
        self.hashes[file] = digest
        self._save()

    def note_sequences(self, archive: Archive, names: list[str]) -> None:
        self.sequences[archive.sequence] = names
        self._save()

    def _save(self) -> None:
        file = self.folder / CHECKSUMS
        beside = file.with_name(file.name + ".new")
        content = {"sha256": self.hashes, "sequences": self.sequences}
        beside.write_text(json.dumps(content, indent=2, sort_keys=True) + "\n", encoding="utf-8")
        beside.replace(file)


_How = tuple[str | None, Progress | None, int, float]


def _download(benchmark: Benchmark, archive: Archive, record: _Record, how: _How) -> Path:
    """The archive in the folder, downloaded from the first address that works."""
    base_url, progress, attempts, pause = how
    failures = []
    # An archive that is already in the folder comes before any address.
    for location in sorted(
        archive.locations, key=lambda location: not (record.folder / location.file).exists()
    ):
        url = location.url if base_url is None else f"{base_url.rstrip('/')}/{location.file}"
        part = record.folder / f"{location.file}.part"
        try:
            return _retrieve(url, location, record, Downloader(part, progress, attempts, pause))
        except DownloadError as error:
            failures.append(str(error))
    raise DownloadError(
        f"{'; '.join(failures)}; on a machine with access, download {_by_hand(benchmark, record)}, "
        f"copy it into {record.folder} and run this again, or unpack it there so that there are "
        f"{benchmark.layout}"
    )


def _by_hand(benchmark: Benchmark, record: _Record) -> str:
    """The addresses of all missing archives."""
    missing = [archive for archive in benchmark.archives if record.unpacked(archive) is None]
    return ", ".join(" or ".join(place.url for place in row.locations) for row in missing)


def _retrieve(url: str, location: Location, record: _Record, downloader: Downloader) -> Path:
    pooch = _load_pooch()
    known = location.sha256 or record.hashes.get(location.file)
    target = record.folder / location.file
    if target.exists() and known is not None and pooch.file_hash(str(target)) != known:
        raise _wrong_checksum(str(target), pooch.file_hash(str(target)), known)
    logger = pooch.get_logger()
    level = logger.level
    logger.setLevel(logging.WARNING)
    try:
        pooch.retrieve(
            url,
            known_hash=f"sha256:{known}" if known else None,
            fname=location.file,
            path=record.folder,
            downloader=downloader,
        )
    except ValueError as error:  # pooch has removed the file
        raise DatasetError(
            f"{url} does not have the expected checksum {known}; if its authors have changed it, "
            f"remove the checksum from {record.folder / CHECKSUMS}, else try another address"
        ) from error
    finally:
        logger.setLevel(level)
    if known is None:
        record.note_hash(location.file, pooch.file_hash(str(target)))
    return target


def _wrong_checksum(file: str, found: str, known: str) -> DatasetError:
    return DatasetError(f"{file} has the checksum {found} instead of {known}; remove it and retry")
