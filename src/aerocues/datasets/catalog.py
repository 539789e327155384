"""How datasets are opened: by their text form, by folder or by files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from difflib import get_close_matches
from fnmatch import fnmatchcase
from pathlib import Path

from aerocues.arguments import check_whole, seconds_of
from aerocues.datasets.dataset import Dataset, Source
from aerocues.datasets.folder import folder_of, open_files
from aerocues.datasets.kinds import CATALOG, DatasetKind
from aerocues.datasets.listing import VIDEO_SUFFIXES, is_own_output
from aerocues.datasets.options import Options
from aerocues.datasets.pairing import PairsFile, parse_pairs
from aerocues.errors import DatasetError

_KINDS = {kind.name: kind for kind in CATALOG}


DatasetLike = Dataset | str | Path | Sequence[str | Path]
"""What functions take as images: a dataset, its text form, a folder, or image files."""


def open_dataset(
    spec: str | Path | Sequence[str | Path],
    *,
    pairs: str | None = None,
    max_width: int | None = None,
    equalize: str = "none",
    max_pairs: int | None = None,
    sequences: str | Sequence[str] | None = None,
    subset: str | None = None,
    band: int | None = None,
    every: float | str | None = None,
) -> Dataset:
    """Open images to measure on.

    Parameters
    ----------
    spec : str, path or sequence of paths
        ``synthetic[:IMAGE]``, ``synthetic-extended[:IMAGE]``, ``oxford:DIR``, ``hpatches:DIR``,
        ``uav:DIR``, ``flight:DIR``, ``simulated:DIR``, ``airsim:DIR``, the path of a plain
        folder or of a video, or two or more image files of one scene, in their order.
    pairs : str, optional
        ``consecutive``, ``consecutive:K``, ``exhaustive``, ``gps``, ``gps:K``, ``gps:50m``,
        ``overlap:0.3-0.9`` or the path of a pairs file; only for kinds without pairs of their own.
    max_width : int, optional
        Wider images are shrunk to this width in pixels, and homographies are scaled accordingly;
        0 keeps the size.
    equalize : str
        ``none``, ``histogram`` or ``clahe``.
    max_pairs : int, optional
        Keep only the first pairs, at most so many.
    sequences : str or sequence of str, optional
        Keep the sequences that match one of these names or globs, in any case; a text is split at
        commas.
    subset : str, optional
        Use only the images whose name or folder, relative to the dataset's, matches one of these
        globs, separated by commas: ``Layer3/pitch-90_yaw0``; only for kinds without pairs of their
        own.
    band : int, optional
        The band of multispectral images, from 1 on: in files of several bands, or among files of
        one band each; of colour images 1 is red, 2 green and 3 blue.
    every : float or str, optional
        Time between two frames of a video: seconds, or a text such as ``"2s"``; 1 s by default.

    Returns
    -------
    Dataset
        Without images that no pair uses; the remaining pairs keep their numbers.

    Raises
    ------
    ArgumentError
        If an option has an invalid value.
    DatasetError
        If the kind is unknown or files are missing.
    """
    if max_pairs is not None:
        check_whole("max_pairs", max_pairs, 1)
    max_width = max_width or None
    seconds = None if every is None else seconds_of("every", every)
    options = Options(pairs, max_width, equalize, subset, band, seconds)
    if isinstance(spec, str | Path):
        kind, target = _parse(str(spec))
        _check_pairs(kind, options)
        opened, text = kind.load(target, options), _absolute(kind, target)
        if kind.name == "folder" and (word := str(spec).lower()) in _KINDS:
            told = f"{spec} is a folder here; write {word}: for the kind of dataset of that name"
            opened = replace(opened, notes=(*opened.notes, told))
    else:
        files = [Path(file).expanduser().absolute() for file in spec]
        folder = folder_of(files)
        opened, text = open_files(folder, files, options), f"flight:{folder}"
    names = sequences if sequences is None or isinstance(sequences, str) else ",".join(sequences)
    source = Source(
        spec=text,
        pairs=_absolute_pairs(pairs),
        max_width=max_width,
        equalize=equalize,
        max_pairs=max_pairs,
        sequences=names,
        subset=subset,
        band=band,
        every=seconds,
    )
    return replace(_restricted(opened, max_pairs, sequences), source=source)


def as_dataset(dataset: DatasetLike) -> Dataset:
    """A dataset as it is, or what `open_dataset` makes of the rest."""
    return dataset if isinstance(dataset, Dataset) else open_dataset(dataset)


def _check_pairs(kind: DatasetKind, options: Options) -> None:
    """Raise DatasetError where a kind that has pairs of its own is to be paired otherwise."""
    if kind.takes_pairs:
        return
    if options.pairs is not None:
        raise DatasetError(f"{kind.name} has pairs of its own; leave `pairs` out")
    if options.subset is not None:
        raise DatasetError(
            f"{kind.name} has pairs of its own; use `sequences` in place of `subset`"
        )


def takes_pairs(spec: str) -> bool:
    """Whether the pairs of this kind of dataset can be chosen."""
    return _parse(spec)[0].takes_pairs


def _absolute(kind: DatasetKind, target: Path | None) -> str:
    """The text form with an absolute path."""
    if target is None:
        return kind.name
    # A plain folder has no prefix; its absolute path cannot be taken for one.
    return str(target.absolute()) if kind.form == "DIR" else f"{kind.name}:{target.absolute()}"


def _absolute_pairs(pairs: str | None) -> str | None:
    if pairs is None or not isinstance(parse_pairs(pairs), PairsFile):
        return pairs
    return str(Path(pairs).expanduser().absolute())


def _parse(spec: str) -> tuple[DatasetKind, Path | None]:
    word, colon, rest = spec.partition(":")
    kind = _KINDS.get(word.lower())
    if kind is not None and (colon or not _means_a_folder(kind, Path(spec))):
        if not rest and kind.target_required:
            raise DatasetError(f"{kind.name} needs a folder; write {kind.name}:DIR")
        return kind, Path(rest).expanduser() if rest else None
    path = Path(spec).expanduser()
    if path.is_dir():
        return _KINDS["folder"], path
    if path.is_file() and path.suffix.lower() in VIDEO_SUFFIXES:
        return _KINDS["video"], path
    if path.is_file():
        raise DatasetError(f"{spec} is a file; give its folder, or synthetic:{spec}")
    close = get_close_matches(word.lower(), _KINDS, n=1)
    meant = f" (did you mean {close[0]}?)" if close else ""
    missing = f"kind of dataset {word}" if colon else f"folder {spec}, nor a kind of dataset"
    forms = ", ".join(row.form for row in CATALOG)
    raise DatasetError(f"there is no {missing}{meant}; use {forms}")


def _means_a_folder(kind: DatasetKind, path: Path) -> bool:
    """Whether a word that is a kind of dataset, too, means the folder of that name.

    The results of `aerocues run synthetic -o synthetic` are no images.
    """
    return path.is_dir() and (kind.target_required or not is_own_output(path))


def _restricted(
    dataset: Dataset, max_pairs: int | None, sequences: str | Sequence[str] | None
) -> Dataset:
    kept = list(dataset.pairs)
    names = sequences.split(",") if isinstance(sequences, str) else sequences
    if globs := [name.strip().lower() for name in names or () if name.strip()]:
        kept = [p for p in kept if any(fnmatchcase(p.sequence.lower(), glob) for glob in globs)]
        if not kept:
            have = ", ".join(dict.fromkeys(pair.sequence for pair in dataset.pairs))
            raise DatasetError(f"no sequence is called {', '.join(globs)}; there are: {have}")
    kept = kept[:max_pairs]
    used = {name for pair in kept for name in (pair.image_1, pair.image_2)}
    images = [image for image in dataset.images if image.name in used]
    return replace(dataset, images=images, pairs=kept)
