"""References of pairs: each is built once, or taken from a folder."""

from __future__ import annotations

from collections import OrderedDict
from pathlib import Path

from aerocues.datasets.dataset import Image
from aerocues.pipeline.feature_source import Announce, silent
from aerocues.pipeline.features import StageError, read_inner, run_stage
from aerocues.pipeline.reference import PreparedImage, Reference, ReferenceBuilder
from aerocues.pipeline.reference_folder import ReferenceFolder, reference_key
from aerocues.processes.call import NO_PAIR, StageCall

# The pairs of a unit of work, and the image that neighbouring pairs share.
REFERENCES_KEPT, IMAGES_KEPT = 5, 2


class ReferenceSource:
    """Finds references; the last ones stay in memory.

    Parameters
    ----------
    folder : path, optional
        Where references are kept for other processes, and taken from.
    announce : callable
        Called before a reference is looked for.
    """

    def __init__(self, folder: Path | None = None, announce: Announce = silent) -> None:
        self._folder = ReferenceFolder(folder) if folder else None
        self._announce = announce
        self._builder: ReferenceBuilder | None = None
        self._references: OrderedDict[str, Reference] = OrderedDict()
        self._images: OrderedDict[str, PreparedImage] = OrderedDict()

    @property
    def problem(self) -> str | None:
        """Why references are no longer kept in the folder, if they are not."""
        return self._folder.problem if self._folder else None

    def reference(self, first: Image, second: Image, pair: int = NO_PAIR) -> Reference:
        """The reference of two images; where it cannot be built, one that says why.

        Parameters
        ----------
        first, second : Image
        pair : int
            The pair that is worked on, for `announce`.
        """
        names = f"{first.name} and {second.name}"
        self._announce(StageCall("reference", pair, names, "flow"))
        try:
            return run_stage("building a reference", lambda: self._found(first, second))
        except StageError as error:  # lack of memory may be over the next time
            return Reference(error.message or error.status)

    def _found(self, first: Image, second: Image) -> Reference:
        key = reference_key(first, second)
        found = self._references.pop(key, None)
        if found is None and self._folder:
            found = self._folder.reference(key)
        if found is None:
            found = self._built(first, second)
            if self._folder:
                self._folder.keep(key, found)
        self._references[key] = found
        if len(self._references) > REFERENCES_KEPT:
            self._references.popitem(last=False)
        return found

    def _built(self, first: Image, second: Image) -> Reference:
        builder = self._builder = self._builder or ReferenceBuilder()
        return builder.build(self._prepared(first, builder), self._prepared(second, builder))

    def _prepared(self, image: Image, builder: ReferenceBuilder) -> PreparedImage:
        key = image.source.content_key()
        found = self._images.pop(key, None) or builder.prepare(read_inner(image))
        self._images[key] = found
        if len(self._images) > IMAGES_KEPT:
            self._images.popitem(last=False)
        return found
