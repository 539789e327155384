"""Oxford and HPatches: image sequences with homographies from the first image."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aerocues.datasets.dataset import Dataset, Image, Pair
from aerocues.datasets.decoding import FileSource
from aerocues.datasets.file_sources import file_sources
from aerocues.datasets.fitting import fitted_size, scale_matrix
from aerocues.datasets.folder import image_paths, settings_of, subfolders
from aerocues.datasets.options import Options
from aerocues.errors import DatasetError, ImageError
from aerocues.phrases import printable
from aerocues.text_files import decoded

AGAIN = "correct it or download the sequence again"
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+([eE][-+]?\d+)?")


@dataclass(frozen=True)
class Layout:
    """The file names of a benchmark.

    Parameters
    ----------
    name : str
        Name of the benchmark and of the dataset.
    image : str
        Regular expression for the stem of an image; its group is the image's number.
    homography : str
        Name of the file with the homography from image 1 to image {number}.
    """

    name: str
    image: str
    homography: str


OXFORD = Layout("oxford", r"img(\d+)", "H1to{number}p")
HPATCHES = Layout("hpatches", r"(\d+)", "H_1_{number}")


def open_oxford(folder: Path, options: Options) -> Dataset:
    """Oxford affine covariant sequences (Mikolajczyk et al., IJCV 2005): image 1 with the others.

    `folder` contains the sequences, or is one. Raises DatasetError if files are missing or invalid.
    """
    return _open(OXFORD, folder, options)


def open_hpatches(folder: Path, options: Options) -> Dataset:
    """HPatches sequences (Balntas et al., CVPR 2017): image 1 with each of the others.

    `folder` contains the sequences, or is one. Raises DatasetError if files are missing or invalid.
    """
    return _open(HPATCHES, folder, options)


def _open(layout: Layout, folder: Path, options: Options) -> Dataset:
    if _numbered(layout, folder):
        sequences = [folder]
    else:
        sequences = [child for child in subfolders(folder) if _numbered(layout, child)]
    if not sequences:
        homography = layout.homography.format(number=2)
        raise DatasetError(
            f"{folder} has no {layout.name} sequence (folders with images 1, 2, ... and files "
            f"{homography}, ...); 'aerocues datasets fetch {layout.name} --to DIR' downloads them"
        )
    images: list[Image] = []
    pairs: list[Pair] = []
    for sequence in sequences:
        own = _sequence(layout, sequence, options)
        images += own[0]
        pairs += [Pair(len(pairs) + i, *fields) for i, fields in enumerate(own[1])]
    settings = settings_of(images, options, pairs="first with each other")
    return Dataset(layout.name, images, pairs, "homography", settings)


def _numbered(layout: Layout, folder: Path) -> dict[int, Path]:
    """Images of a sequence by number; of several files with the same number the first by name."""
    numbered: dict[int, Path] = {}
    for path in image_paths(folder):
        if match := re.fullmatch(layout.image, path.stem):
            numbered.setdefault(int(match[1]), path)
    return dict(sorted(numbered.items()))


PairFields = tuple[str, str, str, NDArray[np.float64]]


def _sequence(
    layout: Layout, folder: Path, options: Options
) -> tuple[list[Image], list[PairFields]]:
    paths = _numbered(layout, folder)
    if 1 not in paths or len(paths) < 2:
        raise DatasetError(f"the sequence {folder} needs image 1 and others; download it again")
    name = printable(folder.resolve().name)
    sources = file_sources(list(paths.values()), options, folder)
    images = {
        number: Image(f"{name}/{printable(path.name)}", source)
        for (number, path), source in zip(paths.items(), sources, strict=True)
    }
    scales = {number: _scale(image) for number, image in images.items()}
    pairs = []
    for number in list(paths)[1:]:
        file = folder / layout.homography.format(number=number)
        matrix = scales[number] @ read_homography(file) @ np.linalg.inv(scales[1])
        pairs.append((images[1].name, images[number].name, name, matrix / matrix[2, 2]))
    return list(images.values()), pairs


def _scale(image: Image) -> NDArray[np.float64]:
    source = image.source
    if not isinstance(source, FileSource) or source.max_width is None:
        return np.eye(3)
    try:
        original = source.original_size()
    except ImageError:  # an error of the pairs with this image, raised when it is read
        return np.eye(3)
    return scale_matrix(original, fitted_size(original, source.max_width))


def read_homography(path: Path) -> NDArray[np.float64]:
    """Read a (3, 3) matrix from a text file with nine numbers.

    Raises
    ------
    DatasetError
        If the file is missing, or is not an invertible matrix of nine numbers.
    """
    try:
        numbers = matrix_numbers(decoded(path.read_bytes()))
    except OSError as error:
        raise DatasetError(f"cannot read the homography {path}: {error.strerror}") from error
    except ValueError as error:
        raise DatasetError(f"{path} is not a homography: {error}; {AGAIN}") from error
    if len(numbers) != 9:
        raise DatasetError(f"{path} has {len(numbers)} numbers in place of nine; {AGAIN}")
    matrix = np.array(numbers, dtype=np.float64).reshape(3, 3)
    if not np.isfinite(matrix).all():
        raise DatasetError(f"{path} has a number that is not finite; {AGAIN}")
    if abs(np.linalg.det(matrix)) < 1e-12 or matrix[2, 2] == 0:
        raise DatasetError(f"{path} is not an invertible homography; {AGAIN}")
    return matrix


def matrix_numbers(text: str) -> list[float]:
    """The numbers of a matrix as programs write it.

    Between numbers may stand blanks, commas, semicolons and brackets; ``#``, ``%`` and ``//`` begin
    comments. Commas inside of numbers are decimal commas where blanks divide the text into nine.

    Raises
    ------
    ValueError
        If there is anything else.
    """
    bare = re.sub(r"[\[\](){};]", " ", re.sub(r"(#|%|//).*", " ", text))
    words = bare.split()
    if len(words) == 9 and any(DECIMAL_COMMA.fullmatch(word) for word in words):
        return [float(word.replace(",", ".")) for word in words]
    return [float(word) for word in bare.replace(",", " ").split()]
