"""Everything that the page shows, as one JSON document."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import version as version_of
from typing import Any

from aerocues.report.arrays import plain
from aerocues.report.comparison import comparison_facts, machine_facts
from aerocues.report.entry import ReportEntry, entry_facts
from aerocues.report.method import incompatible, method_facts


def payload_of(
    entries: Sequence[ReportEntry],
    title: str,
    *,
    images: dict[str, Any] | None = None,
    pictures: Sequence[dict[str, Any]] = (),
    notes: Sequence[str] = (),
) -> dict[str, Any]:
    """The payload of the page.

    Parameters
    ----------
    entries : sequence of ReportEntry
    title : str
    images, pictures
        As `pictures.pictures_of` gives them.
    notes : sequence of str
        What the section on the method is to say besides.
    """
    version = version_of("aerocues")
    scored = [found.entry for found in entries]
    measured = (name for found in entries for name in found.combinations)
    facts = {
        "title": title,
        "made": datetime.now(UTC).isoformat(timespec="seconds"),
        "version": version,
        "entries": [entry_facts(found) for found in entries],
        "comparison": comparison_facts(scored),
        "machines": machine_facts(scored),
        "incompatible": incompatible(measured),
        "images": images or {},
        "pictures": list(pictures),
        "models": [],
        "method": method_facts(version, notes),
    }
    return dict(plain(facts))
