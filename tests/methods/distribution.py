"""Writes a distribution as an installer would leave it: packages beside a ``dist-info`` folder."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

EntryPoints = Mapping[str, Mapping[str, str]]


def write_distribution(
    folder: Path,
    name: str,
    entry_points: EntryPoints,
    code: Mapping[str, str],
    version: str = "1.2",
) -> Path:
    """Install `code` (module path to source) under `folder`, which belongs on ``sys.path``.

    `entry_points` maps a group without its prefix, such as ``detectors``, to names and objects.
    """
    for path, source in code.items():
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(source)
    facts = folder / f"{name.replace('-', '_')}-{version}.dist-info"
    facts.mkdir(parents=True)
    (facts / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
    lines = []
    for group, offered in entry_points.items():
        lines.append(f"[aerocues.{group}]")
        lines += [f"{key} = {value}" for key, value in offered.items()]
    (facts / "entry_points.txt").write_text("\n".join(lines) + "\n")
    return folder
