"""Methods that other packages bring, found through entry points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from aerocues.errors import SelectionError
from aerocues.methods.combination import METHOD_NAME
from aerocues.methods.descriptors import DescriptorRow
from aerocues.methods.detectors import DetectorRow
from aerocues.methods.matchers import MatcherRow
from aerocues.methods.registry import Methods, opencv_methods

GROUPS = ("detectors", "descriptors", "extractors", "matchers")


def load_factory(reference: str) -> Any:
    """The object that an entry point ``module:attribute`` names."""
    return EntryPoint(name="", value=reference, group="").load()


def _try_load(entry: EntryPoint) -> tuple[Any, str | None]:
    """The factory and None, or None and the reason why it cannot be loaded."""
    try:
        return entry.load(), None
    except ImportError as error:
        return None, str(error)
    except AttributeError as error:
        return None, f"{entry.value} does not exist: {error}"
    except Exception as error:  # noqa: BLE001 - a third-party module may raise anything
        return None, f"{type(error).__name__}: {error}"


def _entries(group: str) -> Iterator[tuple[str, EntryPoint, str]]:
    """Name, entry point and distribution with its version, of each plug-in of a group."""
    for entry in sorted(entry_points(group=f"aerocues.{group}"), key=lambda entry: entry.name):
        name = entry.name.upper()
        origin = f"{entry.dist.name} {entry.dist.version}" if entry.dist else entry.module
        if not METHOD_NAME.fullmatch(name):
            raise SelectionError(
                f"the plug-in {origin} offers a method called {entry.name!r}; its name may "
                "consist of A-Z, 0-9 and _ only: rename its entry point"
            )
        yield name, entry, origin


def _detector(name: str, entry: EntryPoint, origin: str) -> DetectorRow:
    factory, problem = _try_load(entry)
    return DetectorRow(
        name,
        entry.value,
        dict(getattr(factory, "parameters", {})),
        str(getattr(factory, "reference", "")),
        origin=origin,
        unavailable=problem,
    )


def _descriptor(name: str, entry: EntryPoint, origin: str, *, own_keypoints: bool) -> DescriptorRow:
    factory, problem = _try_load(entry)
    dtype = getattr(factory, "dtype", "float32")
    if problem is None and dtype not in ("uint8", "float32"):
        problem = f"its dtype must be 'uint8' or 'float32', not {dtype!r}"
    return DescriptorRow(
        name,
        entry.value,
        dict(getattr(factory, "parameters", {})),
        str(getattr(factory, "reference", "")),
        "uint8" if dtype == "uint8" else "float32",
        only_detectors=(name,) if own_keypoints else (),
        origin=origin,
        unavailable=problem,
    )


def _matcher(name: str, entry: EntryPoint, origin: str) -> MatcherRow:
    factory, problem = _try_load(entry)
    dtypes = dict(getattr(factory, "dtypes", {}))
    if problem is None and not dtypes:
        problem = "it does not state which norms and descriptor types it takes ('dtypes')"
    return MatcherRow(
        name,
        str(getattr(factory, "title", name)),
        str(getattr(factory, "reference", "")),
        {norm: dict(getattr(factory, "parameters", {})) for norm in dtypes},
        dtypes or {"L2": ("float32",), "HAM": ("uint8",)},
        factory=entry.value,
        origin=origin,
        unavailable=problem,
    )


def _check_new(kind: str, name: str, origin: str, known: Mapping[str, object]) -> None:
    if name in known:
        raise SelectionError(
            f"the plug-in {origin} offers a {kind} {name}, which exists already; "
            "rename its entry point or uninstall one of the two"
        )


def installed_methods() -> Methods:
    """OpenCV's methods and those of the plug-ins installed beside aerocues.

    Raises
    ------
    SelectionError
        If a plug-in's name is malformed or taken.
    """
    base = opencv_methods()
    detectors, descriptors = dict(base.detectors), dict(base.descriptors)
    matchers = dict(base.matchers)
    for group in GROUPS:
        for name, entry, origin in _entries(group):
            if group in ("detectors", "extractors"):
                _check_new("detector", name, origin, detectors)
                detectors[name] = _detector(name, entry, origin)
            if group in ("descriptors", "extractors"):
                _check_new("descriptor", name, origin, descriptors)
                descriptors[name] = _descriptor(
                    name, entry, origin, own_keypoints=group == "extractors"
                )
            if group == "matchers":
                _check_new("matcher", name, origin, matchers)
                matchers[name] = _matcher(name, entry, origin)
    return Methods(detectors, descriptors, base.norms, matchers)
