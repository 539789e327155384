"""Options for opening a dataset of any kind."""

from __future__ import annotations

from dataclasses import dataclass
from fnmatch import fnmatchcase
from itertools import accumulate

from aerocues.arguments import check_whole
from aerocues.datasets.fitting import check_settings


@dataclass(frozen=True)
class Options:
    """Options for pairing and reading images.

    Parameters
    ----------
    pairs : str or None
        Text form of a pair strategy (see `parse_pairs`); None: the default of the dataset's kind.
    max_width : int or None
        Wider images are shrunk to this width in pixels.
    equalize : str
        ``none``, ``histogram`` or ``clahe``.
    subset : str or None
        Use only images whose name or folder matches one of these globs, ignoring case; None: all.
    band : int or None
        The band of multispectral images to read, from 1 on, in files of several bands or among
        files of one band each.
    every : float or None
        Seconds between two frames of a video.
    """

    pairs: str | None = None
    max_width: int | None = None
    equalize: str = "none"
    subset: str | None = None
    band: int | None = None
    every: float | None = None

    def __post_init__(self) -> None:
        check_settings(self.max_width, self.equalize)
        if self.band is not None:
            check_whole("band", self.band, 1)

    def settings(self, **more: str) -> tuple[tuple[str, str], ...]:
        """The options for `Dataset.settings`, with further ones of the kind of dataset."""
        width = "full" if self.max_width is None else str(self.max_width)
        chosen = {} if self.subset is None else {"subset": self.subset}
        chosen |= {} if self.band is None else {"band": str(self.band)}
        return (*more.items(), *chosen.items(), ("max_width", width), ("equalize", self.equalize))

    def takes(self, name: str) -> bool:
        """Whether the subset includes an image of this name (relative to the dataset's folder)."""
        if self.subset is None:
            return True
        folders = accumulate(name.lower().split("/"), lambda path, part: f"{path}/{part}")
        globs = [glob.strip().strip("/").lower() for glob in self.subset.split(",")]
        return any(fnmatchcase(place, glob) for place in folders for glob in globs)
