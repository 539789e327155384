"""The kinds of dataset, as a table, and how a dataset is opened by its text form."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from fnmatch import fnmatchcase
from pathlib import Path

from aerocues.datasets.dataset import Dataset, Geometry, Source
from aerocues.datasets.folder import open_flight, open_folder
from aerocues.datasets.homography_sequences import open_hpatches, open_oxford
from aerocues.datasets.options import Options
from aerocues.datasets.pairing import PairsFile, parse_pairs
from aerocues.datasets.simulated import open_simulated
from aerocues.datasets.synthetic import open_synthetic
from aerocues.datasets.uav import open_uav
from aerocues.errors import DatasetError


@dataclass(frozen=True)
class DatasetKind:
    """One row of the catalog.

    Parameters
    ----------
    name : str
        Word before the colon of a dataset's text form.
    form : str
        How to write it.
    pairs : str
        Which images are paired.
    ground_truth : str
        What is known to be true.
    needs : str
        What must be there.
    layout : str
        How the files lie.
    geometry : str
        ``homography`` or ``epipolar``.
    where : str
        Where to get it.
    terms : str
        Terms of use of the images.
    load : callable
        Opens it, from the path after the colon (None: none given) and the options.
    takes_pairs : bool
        Whether the user may choose the pairs.
    target : str or None
        What stands after the colon, ``DIR`` or ``IMAGE``.
    target_required : bool
        Whether there must be one.
    """

    name: str
    form: str
    pairs: str
    ground_truth: str
    needs: str
    layout: str
    geometry: Geometry
    where: str
    terms: str
    load: Callable[[Path | None, Options], Dataset]
    takes_pairs: bool
    target: str = "DIR"
    target_required: bool = True


def _in_folder(
    load: Callable[[Path, Options], Dataset],
) -> Callable[[Path | None, Options], Dataset]:
    def load_existing(folder: Path | None, options: Options) -> Dataset:
        if folder is None or not folder.is_dir():
            raise DatasetError(f"there is no folder {folder}; check the path")
        return load(folder, options)

    return load_existing


CATALOG: tuple[DatasetKind, ...] = (
    DatasetKind(
        name="synthetic",
        form="synthetic[:IMAGE]",
        pairs="original with each of 20 transformations: rotation, scale, intensity",
        ground_truth="exact homographies",
        needs="nothing, or an image of yours",
        layout="one image file",
        geometry="homography",
        where="drawn by aerocues",
        terms="Apache-2.0 (the drawn image)",
        load=lambda image, options: open_synthetic(image, options, "synthetic"),
        takes_pairs=False,
        target="IMAGE",
        target_required=False,
    ),
    DatasetKind(
        name="synthetic-extended",
        form="synthetic-extended[:IMAGE]",
        pairs="original with each of 47: rotation to 180, contrast, noise, blur, JPEG, tilt too",
        ground_truth="exact homographies",
        needs="nothing, or an image of yours",
        layout="one image file",
        geometry="homography",
        where="drawn by aerocues",
        terms="Apache-2.0 (the drawn image)",
        load=lambda image, options: open_synthetic(image, options, "synthetic-extended"),
        takes_pairs=False,
        target="IMAGE",
        target_required=False,
    ),
    DatasetKind(
        name="oxford",
        form="oxford:DIR",
        pairs="image 1 with 2 to 6 of each of 8 sequences: 40",
        ground_truth="homographies",
        needs="the Oxford affine covariant sequences",
        layout="DIR/graf/img1.ppm ... img6.ppm, H1to2p ... H1to6p (also .png, .pgm, .jpg)",
        geometry="homography",
        where="aerocues datasets fetch oxford --to DIR",
        terms="not stated by the authors; used everywhere for research",
        load=_in_folder(open_oxford),
        takes_pairs=False,
    ),
    DatasetKind(
        name="hpatches",
        form="hpatches:DIR",
        pairs="image 1 with 2 to 6 of each of 116 sequences: 580",
        ground_truth="homographies",
        needs="the HPatches sequences (full images, not patches)",
        layout="DIR/v_churchill/1.ppm ... 6.ppm, H_1_2 ... H_1_6 (also .png, .jpg)",
        geometry="homography",
        where="aerocues datasets fetch hpatches --to DIR",
        terms="MIT",
        load=_in_folder(open_hpatches),
        takes_pairs=False,
    ),
    DatasetKind(
        name="uav",
        form="uav:DIR",
        pairs="consecutive images of each project; others with --pairs",
        ground_truth="none",
        needs="a folder of projects with two or more images each",
        layout="DIR/project/1.jpg, 2.jpg",
        geometry="epipolar",
        where="your own",
        terms="your own",
        load=_in_folder(open_uav),
        takes_pairs=True,
    ),
    DatasetKind(
        name="flight",
        form="flight:DIR",
        pairs="consecutive by name; others with --pairs",
        ground_truth="GPS positions from EXIF, where there are any",
        needs="the images of one flight, in a folder or a tree of folders",
        layout="DIR/**/*.jpg",
        geometry="epipolar",
        where="your own",
        terms="your own",
        load=_in_folder(open_flight),
        takes_pairs=True,
    ),
    DatasetKind(
        name="simulated",
        form="simulated:DIR",
        pairs="consecutive by name in each folder; others with --pairs",
        ground_truth="exact poses, intrinsics and depth",
        needs="a flight that aerocues simulate has made",
        layout="DIR/**/*.png (.jpg), DIR/truth/poses.csv, camera.json, depth/**/*.npy",
        geometry="epipolar",
        where="aerocues simulate -o DIR",
        terms="your own",
        load=_in_folder(open_simulated),
        takes_pairs=True,
    ),
    DatasetKind(
        name="folder",
        form="DIR",
        pairs="consecutive by name; others with --pairs",
        ground_truth="none; GPS positions where EXIF has them",
        needs="any folder with two or more images",
        layout="DIR/*.jpg (.png, .tif, .bmp, .webp, .ppm, .pgm)",
        geometry="epipolar",
        where="your own",
        terms="your own",
        load=_in_folder(open_folder),
        takes_pairs=True,
    ),
)
_KINDS = {kind.name: kind for kind in CATALOG}


def open_dataset(
    spec: str,
    *,
    pairs: str | None = None,
    max_width: int | None = None,
    equalize: str = "none",
    limit: int | None = None,
    sequences: str | Sequence[str] | None = None,
    subset: str | None = None,
) -> Dataset:
    """Open a dataset by its text form.

    Parameters
    ----------
    spec : str
        ``synthetic[:IMAGE]``, ``synthetic-extended[:IMAGE]``, ``oxford:DIR``, ``hpatches:DIR``,
        ``uav:DIR``, ``flight:DIR``, ``simulated:DIR``, or the path of a plain folder.
    pairs : str, optional
        ``consecutive``, ``consecutive:K``, ``exhaustive``, ``gps``, ``gps:K``, ``gps:50m``,
        ``overlap:0.3-0.9`` or the path of a pairs file; for the kinds without pairs of their own.
    max_width : int, optional
        Wider images are shrunk to this width in pixels; homographies are scaled along.
    equalize : str
        ``none``, ``histogram`` or ``clahe``.
    limit : int, optional
        Keep the first pairs only.
    sequences : str or sequence of str, optional
        Keep the sequences that match one of these names or globs, in any case; a text is split at
        its commas.
    subset : str, optional
        Use only the images whose name or folder, relative to the dataset's, matches one of these
        globs, separated by commas: ``Layer3/pitch-90_yaw0``; for the kinds without pairs of their
        own.

    Returns
    -------
    Dataset
        Without the images that no pair uses; the pairs that are left keep their numbers.

    Raises
    ------
    DatasetError
        If the kind is unknown, something is missing, or an option makes no sense.
    """
    if limit is not None and limit < 1:
        raise DatasetError(f"--limit {limit} leaves no pairs; give 1 or more")
    kind, target = _parse(spec)
    if pairs is not None and not kind.takes_pairs:
        raise DatasetError(f"{kind.name} has pairs of its own; leave --pairs out")
    if subset is not None and not kind.takes_pairs:
        raise DatasetError(
            f"{kind.name} has pairs of its own; use --sequences in place of --subset"
        )
    dataset = kind.load(target, Options(pairs, max_width, equalize, subset))
    names = sequences if sequences is None or isinstance(sequences, str) else ",".join(sequences)
    source = Source(
        spec=_absolute(kind, target),
        pairs=_absolute_pairs(pairs),
        max_width=max_width,
        equalize=equalize,
        limit=limit,
        sequences=names,
        subset=subset,
    )
    return replace(_restricted(dataset, limit, sequences), source=source)


def _absolute(kind: DatasetKind, target: Path | None) -> str:
    """The text form of a dataset that means the same in any folder."""
    if target is None:
        return kind.name
    # A plain folder has no word before a colon; nor does its path begin with one, being absolute.
    return str(target.absolute()) if kind.form == "DIR" else f"{kind.name}:{target.absolute()}"


def _absolute_pairs(pairs: str | None) -> str | None:
    if pairs is None or not isinstance(parse_pairs(pairs), PairsFile):
        return pairs
    return str(Path(pairs).expanduser().absolute())


def _parse(spec: str) -> tuple[DatasetKind, Path | None]:
    word, colon, rest = spec.partition(":")
    kind = _KINDS.get(word.lower())
    if kind is not None and (colon or not Path(spec).is_dir()):
        if not rest and kind.target_required:
            raise DatasetError(f"{kind.name} needs a folder; write {kind.name}:DIR")
        return kind, Path(rest).expanduser() if rest else None
    path = Path(spec).expanduser()
    if path.is_dir():
        return _KINDS["folder"], path
    if path.is_file():
        raise DatasetError(f"{spec} is a file; give its folder, or synthetic:{spec}")
    close = get_close_matches(word.lower(), _KINDS, n=1)
    meant = f" (did you mean {close[0]}?)" if close else ""
    forms = ", ".join(row.form for row in CATALOG)
    raise DatasetError(f"{spec} is neither a kind of dataset{meant} nor a folder; use {forms}")


def _restricted(
    dataset: Dataset, limit: int | None, sequences: str | Sequence[str] | None
) -> Dataset:
    kept = list(dataset.pairs)
    names = sequences.split(",") if isinstance(sequences, str) else sequences
    if globs := [name.strip().lower() for name in names or () if name.strip()]:
        kept = [p for p in kept if any(fnmatchcase(p.sequence.lower(), glob) for glob in globs)]
        if not kept:
            have = ", ".join(dict.fromkeys(pair.sequence for pair in dataset.pairs))
            raise DatasetError(f"no sequence is called {', '.join(globs)}; there are: {have}")
    kept = kept[:limit]
    used = {name for pair in kept for name in (pair.image_1, pair.image_2)}
    images = [image for image in dataset.images if image.name in used]
    return replace(dataset, images=images, pairs=kept)
