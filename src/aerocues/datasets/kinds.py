"""The kinds of dataset, as a table: one row each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from aerocues.datasets.dataset import Dataset, Geometry
from aerocues.datasets.folder import open_flight, open_folder
from aerocues.datasets.homography_sequences import open_hpatches, open_oxford
from aerocues.datasets.options import Options
from aerocues.datasets.simulated import open_simulated
from aerocues.datasets.synthetic import open_synthetic
from aerocues.datasets.uav import open_uav
from aerocues.datasets.video import open_video
from aerocues.errors import DatasetError


@dataclass(frozen=True)
class DatasetKind:
    """One row of the catalog.

    Parameters
    ----------
    name : str
        Word before the colon of a dataset's text form.
    form : str
        Text form.
    pairs : str
        Which images are paired.
    ground_truth : str
        Available ground truth.
    needs : str
        Required files.
    layout : str
        Arrangement of the files.
    geometry : str
        ``homography`` or ``epipolar``.
    where : str
        Source of the files.
    terms : str
        Terms of use of the images.
    load : callable
        Opens it, from the path after the colon (None if there is none) and the options.
    takes_pairs : bool
        Whether the user may choose the pairs.
    target : str or None
        What follows the colon: ``DIR``, ``IMAGE`` or ``FILE``.
    target_required : bool
        Whether the target is required.
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


def _load_video(path: Path | None, options: Options) -> Dataset:
    if path is None or not path.is_file():
        raise DatasetError(f"there is no video {path}; check the path")
    return open_video(path, options)


CATALOG: tuple[DatasetKind, ...] = (
    DatasetKind(
        name="synthetic",
        form="synthetic[:IMAGE]",
        pairs="original with each of 20 transformations: rotation, scale, intensity",
        ground_truth="exact homographies",
        needs="nothing, or one of your images",
        layout="one image file",
        geometry="homography",
        where="part of aerocues",
        terms="Apache-2.0 (the image in aerocues)",
        load=lambda image, options: open_synthetic(image, options, "synthetic"),
        takes_pairs=False,
        target="IMAGE",
        target_required=False,
    ),
    DatasetKind(
        name="synthetic-extended",
        form="synthetic-extended[:IMAGE]",
        pairs="original with each of 47: also rotation to 180, contrast, noise, blur, JPEG, tilt",
        ground_truth="exact homographies",
        needs="nothing, or one of your images",
        layout="one image file",
        geometry="homography",
        where="part of aerocues",
        terms="Apache-2.0 (the image in aerocues)",
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
        terms="not stated by the authors; widely used in research",
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
        pairs="as chosen; consecutive images of each project by default",
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
        pairs="as chosen; consecutive by name by default",
        ground_truth="GPS positions from EXIF, if present",
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
        pairs="as chosen; consecutive by name in each folder by default",
        ground_truth="exact poses, intrinsics and depth",
        needs="a flight made by aerocues simulate",
        layout="DIR/**/*.png (.jpg), DIR/truth/poses.csv, camera.json, depth/**/*.npy",
        geometry="epipolar",
        where="aerocues simulate -o DIR",
        terms="your own",
        load=_in_folder(open_simulated),
        takes_pairs=True,
    ),
    DatasetKind(
        name="airsim",
        form="airsim:DIR",
        pairs="as chosen; consecutive by name in each folder by default",
        ground_truth="exact poses, intrinsics and depth",
        needs="a flight made by aerocues airsim collect",
        layout="as a simulated flight",
        geometry="epipolar",
        where="aerocues airsim collect -o DIR",
        terms="those of the simulator's scene",
        load=_in_folder(open_simulated),
        takes_pairs=True,
    ),
    DatasetKind(
        name="video",
        form="video:FILE",
        pairs="as chosen; consecutive frames by default",
        ground_truth="GPS positions from subtitles of the drone beside it, if present",
        needs="a video that OpenCV reads; one frame a second is taken, or as many as `every` says",
        layout="FILE.MP4, FILE.SRT",
        geometry="epipolar",
        where="your own",
        terms="your own",
        load=_load_video,
        takes_pairs=True,
        target="FILE",
    ),
    DatasetKind(
        name="folder",
        form="DIR",
        pairs="as chosen; consecutive by name by default",
        ground_truth="none; GPS positions from EXIF, if present",
        needs="any folder with two or more images",
        layout="DIR/*.jpg (.png, .tif, .bmp, .webp, .ppm, .pgm)",
        geometry="epipolar",
        where="your own",
        terms="your own",
        load=_in_folder(open_folder),
        takes_pairs=True,
    ),
)
