"""A third-party package with one method of each kind, in the words of the guide's interfaces."""

from __future__ import annotations

SOURCE = '''
from __future__ import annotations

import numpy as np

from aerocues.methods.arrays import Features, Keypoints, Matches


def _corners(image, step):
    gray = image.astype(np.float32).mean(axis=2)
    change = np.abs(np.diff(gray, axis=0))[:, :-1] * np.abs(np.diff(gray, axis=1))[:-1]
    change[:8], change[-8:], change[:, :8], change[:, -8:] = 0, 0, 0, 0
    order = np.argsort(-change, axis=None, kind="stable")[:200 * step:step]
    rows, columns = np.unravel_index(order, change.shape)
    return Keypoints.from_xy(np.column_stack([columns, rows]))


def _patches(image, keypoints):
    columns, rows = np.rint(keypoints.xy).astype(int).T
    reach = np.arange(-4, 5)
    patches = image[rows[:, None, None] + reach[:, None], columns[:, None, None] + reach]
    return patches.reshape(len(keypoints), -1)


class Corners:
    """Detector."""

    reference = "Nobody, Corners by two differences, 2024"
    parameters = {"step": 1}

    def __init__(self, step=1):
        self.step = step

    def detect(self, image):
        return _corners(image, self.step)


class Patches:
    """Descriptor of numbers."""

    dtype = "float32"
    reference = "Nobody, Patches as they are, 2024"

    def describe(self, image, keypoints):
        height, width = image.shape[:2]
        inside = (keypoints.xy > 5) & (keypoints.xy < (width - 6, height - 6))
        kept = keypoints.take(inside.all(axis=1))
        return Features(kept, _patches(image, kept).astype(np.float32))


class CornerBits:
    """Extractor: detector and descriptor of bits in one."""

    dtype = "uint8"

    def extract(self, image):
        keypoints = _corners(image, 1)
        patches = _patches(image, keypoints).astype(int)
        return Features(keypoints, np.packbits(patches[:, :-1] > patches[:, 1:], axis=1)[:, :16])


class Mutual:
    """Matcher that knows L2 only."""

    title = "mutual neighbours in numpy"
    dtypes = {"L2": ("float32",)}
    takes_descriptors = ("Patches", "SIFT")
    upright = True

    def match(self, features_1, features_2, norm):
        assert norm == "L2"
        first, second = features_1.descriptors, features_2.descriptors
        table = np.linalg.norm(first[:, None] - second[None], axis=2)
        forth, back = table.argmin(axis=1), table.argmin(axis=0)
        rows = np.flatnonzero(back[forth] == np.arange(len(first)))
        pairs = np.column_stack([rows, forth[rows]]).astype(np.int32)
        return Matches(pairs, table[rows, forth[rows]].astype(np.float32))
'''

NEEDY = "import package_that_nobody_has\n"

ENTRY_POINTS = {
    "detectors": {"corners": "arena.methods:Corners", "needy": "arena.needy:Anything"},
    "descriptors": {"Patches": "arena.methods:Patches", "mistyped": "arena.methods:Patchs"},
    "extractors": {"CORNER_BITS": "arena.methods:CornerBits"},
    "matchers": {"mutual": "arena.methods:Mutual"},
}

CODE = {
    "arena/__init__.py": "",
    "arena/methods.py": SOURCE,
    "arena/needy.py": NEEDY,
}
