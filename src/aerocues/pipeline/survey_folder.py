"""Surveys on disk: the next command on the same images does not look at them again."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, astuple
from pathlib import Path

import cv2

from aerocues.datasets.dataset import Image
from aerocues.errors import ImageError, StoreError
from aerocues.methods.exact.availability import why_not_exact
from aerocues.pipeline.survey import Survey, SurveyedPair
from aerocues.results.hashing import content_hash
from aerocues.results.whole_files import json_content, write_whole

# Raised whenever the same images would give another survey.
SURVEY_VERSION = 2


def survey_key(images: Sequence[Image], seed: int) -> str:
    """The hash of all that decides a survey: pixels, order, GPS, seed and versions."""
    listed = [
        [image.name, _content(image), None if image.gps is None else astuple(image.gps)]
        for image in images
    ]
    return content_hash([SURVEY_VERSION, cv2.__version__, why_not_exact() is None, seed, listed])


def _content(image: Image) -> str:
    try:
        return image.source.content_key()
    except ImageError as error:  # the survey tells which images cannot be read
        return str(error)


def read_survey(folder: Path, key: str) -> Survey | None:
    """The survey of a key; None where it is not here, or its file is damaged."""
    try:
        stored = json.loads(_file(folder, key).read_text(encoding="utf-8"))
        return Survey(
            tuple(map(str, stored["images"])),
            tuple((int(first), int(second)) for first, second in stored["candidates"]),
            tuple(SurveyedPair(**pair) for pair in stored["pairs"]),
            tuple((str(name), str(reason)) for name, reason in stored["unreadable"]),
        )
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None


def write_survey(folder: Path, key: str, survey: Survey) -> None:
    """Keep a survey.

    Raises
    ------
    StoreError
        If the disk is full or the folder is not writable.
    """
    file = _file(folder, key)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_whole({file: json_content(asdict(survey))})
    except OSError as error:
        raise StoreError(
            f"cannot write {file}: {error.strerror}; make room, or choose another `output`"
        ) from error


def _file(folder: Path, key: str) -> Path:
    return folder / f"{key}.json"
