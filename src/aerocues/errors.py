"""The errors that aerocues raises on purpose. Each message ends with what to do next.

Messages use the words of Python, between backticks: `max_keypoints` is a parameter,
`pairs="exhaustive"` a parameter with a value, `aerocues.run` a function. The command line replaces
them by its own options and commands when it prints a message (`cli.wording`).
"""

from __future__ import annotations


class AerocuesError(Exception):
    """Base of every error that a user can act on; the command line prints it in one line."""


class DamageWarning(UserWarning):
    """A file is damaged or missing; what does not depend on it goes on without it."""


class ArgumentError(AerocuesError):
    """An argument has a value that makes no sense, whatever is measured."""


class SelectionError(AerocuesError):
    """A combination, method or preset was named that does not exist or cannot be used."""


class DatasetError(AerocuesError):
    """A dataset is missing, incomplete or of the wrong form."""


class ImageError(DatasetError):
    """An image cannot be read, is truncated, too large or of an unknown format."""


class MethodUnavailableError(AerocuesError):
    """A method exists but what it needs (a package, a build option of OpenCV) does not."""


class MethodFailedError(AerocuesError):
    """A method failed on an image or a pair of images."""


class StoreError(AerocuesError):
    """A results folder cannot be read or written."""


class EngineError(AerocuesError):
    """The workers that measure could not be started or kept alive."""


class ScoreError(AerocuesError):
    """A table cannot be scored or compared as asked."""


class ReconstructionError(AerocuesError):
    """A scene cannot be reconstructed as asked."""


class FocalLengthError(ReconstructionError):
    """Nothing tells the focal length of some images, and the mapper may not estimate it."""


class SimulationError(AerocuesError):
    """A flight cannot be simulated as asked."""
