"""Everything that the page shows, as one JSON document."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import version as version_of
from typing import Any

from aerocues.report.arrays import plain
from aerocues.report.clouds import Clouds
from aerocues.report.comparison import comparison_facts, machine_facts
from aerocues.report.entry import ReportEntry, entry_facts
from aerocues.report.flight_map import FlightMap
from aerocues.report.method import incompatible, method_facts
from aerocues.report.pictures import Pictures
from aerocues.report.scores import cautions


def payload_of(
    entries: Sequence[ReportEntry],
    title: str,
    *,
    pictures: Pictures | None = None,
    clouds: Clouds | None = None,
    maps: Sequence[FlightMap] = (),
) -> dict[str, Any]:
    """The payload of the page.

    Parameters
    ----------
    entries : sequence of ReportEntry
    title : str
    pictures : Pictures, optional
    clouds : Clouds, optional
    maps : sequence of FlightMap
        Notes of all are shown in the section on the method.
    """
    version = version_of("aerocues")
    shown, modelled = pictures or Pictures(), clouds or Clouds()
    cautioned = [f"{found.name}: {each}" for found in entries for each in cautions(found.ranking)]
    drawn = [note for each in maps for note in each.notes]
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
        "images": shown.images,
        "pictures": shown.pictures,
        "clouds": modelled.clouds,
        "maps": [each.facts for each in maps if each.facts],
        "method": method_facts(version, [*cautioned, *modelled.notes, *drawn, *shown.notes]),
    }
    return dict(plain(facts))
