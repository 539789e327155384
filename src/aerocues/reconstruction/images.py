"""Images in the folder of models, for COLMAP and others, and their cameras."""

from __future__ import annotations

import shutil
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2

from aerocues.datasets.dataset import Dataset, Image, PinholeCamera, Pixels
from aerocues.datasets.decoding import FileSource
from aerocues.errors import FocalLengthError, ReconstructionError
from aerocues.reconstruction.focal_lengths import exif_focal_length
from aerocues.reconstruction.prepared import Prepared
from aerocues.reconstruction.protocol import ReconstructionProtocol
from aerocues.reconstruction.scene import CameraGroup

GUESSED, EXIF = "guessed", "EXIF"
# Where a focal length is from that a calibration may replace: neither the truth nor a user's own.
CALIBRATABLE = (GUESSED, EXIF)
JPEG_QUALITY = 95
COPIED = ("JPEG", "PNG", "TIFF", "BMP")
"""Formats that all versions of COLMAP read; others are written as PNG."""
HALF_PIXEL = 0.5


def prepare_image(image: Image, folder: Path) -> Prepared:
    """Write the measured image into a folder, and read the focal length from its EXIF data.

    Raises
    ------
    ImageError
        If the image cannot be read.
    ReconstructionError
        If it cannot be written.
    """
    pixels = image.read()
    height, width = pixels.bgr.shape[:2]
    target = folder / image.name
    target.parent.mkdir(parents=True, exist_ok=True)
    source = image.source
    try:
        if isinstance(source, FileSource) and _as_it_is(source):
            shutil.copyfile(source.path, target)
        else:
            target.write_bytes(_encoded(pixels, target))
    except OSError as error:
        raise ReconstructionError(
            f"cannot write {target} ({error.strerror}); make room or choose another `output`"
        ) from error
    focal_length = None
    if isinstance(source, FileSource):
        focal_length = exif_focal_length(source, max(width, height))
    return Prepared(image.name, width, height, focal_length)


def _as_it_is(source: FileSource) -> bool:
    """Whether the original file has exactly the measured pixels, for COLMAP, too."""
    header = source.header()
    shrunk = source.max_width is not None and header.size[0] > source.max_width
    changed = shrunk or source.equalize != "none" or header.orientation != 1
    return not changed and source.is_plain() and header.format in COPIED


def _encoded(pixels: Pixels, target: Path) -> bytes:
    """A file for COLMAP, which tells formats by their content: JPEG by its suffix, else PNG."""
    jpeg = target.suffix.lower() in (".jpg", ".jpeg")
    options = [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY] if jpeg else []
    _, content = cv2.imencode(".jpg" if jpeg else ".png", pixels.bgr, options)
    return bytes(content)


def cameras_of(
    dataset: Dataset, prepared: list[Prepared], protocol: ReconstructionProtocol
) -> tuple[CameraGroup, ...]:
    """The cameras of a scene: one per image size and focal length."""
    groups: defaultdict[tuple[Any, ...], list[str]] = defaultdict(list)
    for each in prepared:
        truth = dataset.image(each.name).truth
        if truth is not None:
            found = _true_camera(truth.camera)
        else:
            focal_length = protocol.focal_length or each.focal_length
            found = _camera_of_size(each, focal_length, "given" if protocol.focal_length else EXIF)
        groups[(each.width, each.height, *found)].append(each.name)
    return tuple(
        CameraGroup(model, parameters, source, tuple(names))
        for (_, _, model, parameters, source), names in groups.items()
    )


def require_focal_lengths(cameras: Sequence[CameraGroup], protocol: ReconstructionProtocol) -> None:
    """Refuse to keep intrinsics as they are where they are not known.

    Raises
    ------
    FocalLengthError
    """
    unknown = [name for group in cameras if not group.parameters for name in group.names]
    if unknown and not protocol.refined:
        total = sum(len(group.names) for group in cameras)
        known = sorted({round(group.parameters[0], 1) for group in cameras if group.parameters})
        others = f", and the others have {', '.join(map(str, known[:3]))} px" if known else ""
        raise FocalLengthError(
            f"the focal length of {len(unknown)} of {total} images is not known "
            f"({unknown[0]}, ...){others}; give `focal_length` in pixels, or let the mapper "
            'estimate it with `intrinsics="refine"`'
        )


def _camera_of_size(
    image: Prepared, focal_length: float | None, source: str
) -> tuple[str, tuple[float, ...], str]:
    if focal_length is None:
        return "SIMPLE_RADIAL", (), GUESSED
    return "SIMPLE_RADIAL", (focal_length, image.width / 2, image.height / 2, 0.0), source


def _true_camera(camera: PinholeCamera) -> tuple[str, tuple[float, ...], str]:
    return (
        "PINHOLE",
        (
            camera.focal_x,
            camera.focal_y,
            camera.centre_x + HALF_PIXEL,
            camera.centre_y + HALF_PIXEL,
        ),
        "truth",
    )
