"""The project's own files: nothing in them that ties them to one machine, versions that agree."""

from __future__ import annotations

import importlib.metadata
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

REGISTRY_HOSTS = tuple(
    ".".join(parts)
    for parts in (
        ("pypi", "org"),
        ("pythonhosted", "org"),
        ("registry", "npmjs", "org"),
        ("anaconda", "org"),
        ("deb", "debian", "org"),
    )
)
MACHINE_PATH = re.compile(r"(?<![\w.~/-])/(?:root|work|mnt|Users|home)/\w")
LONGEST_SOURCE_FILE = 320
HEAVY_MODULES = (
    *("cv2", "distributed", "numba", "plotly", "polars", "pooch", "pyarrow", "pycolmap", "scipy"),
)


@pytest.fixture(scope="module")
def tracked_texts(repository: Path) -> dict[str, str]:
    """Text of every tracked file, by its path."""
    listing = subprocess.run(
        ["git", "ls-files", "-z"], cwd=repository, capture_output=True, text=True, check=False
    )
    if listing.returncode:
        pytest.skip("not a git checkout")
    texts = {}
    for name in filter(None, listing.stdout.split("\0")):
        path = repository / name
        if path.is_file():
            texts[name] = path.read_bytes().decode("utf-8", errors="ignore")
    return texts


@pytest.fixture(scope="module")
def project(repository: Path) -> dict[str, Any]:
    """The table [project] of pyproject.toml and its groups of dependencies."""
    with (repository / "pyproject.toml").open("rb") as file:
        return tomllib.load(file)


@pytest.fixture(scope="module")
def pins(repository: Path) -> dict[str, list[str]]:
    """What requirements.lock pins."""
    return pins_in(repository / "requirements.lock")


def pins_in(lock: Path) -> dict[str, list[str]]:
    """Lines of a lock file by package: pin and hashes of each pinned version."""
    pins: dict[str, list[str]] = {}
    for entry in re.split(r"\n(?=\S)", lock.read_text()):
        found = re.match(r"([A-Za-z0-9._-]+)==", entry)
        assert found or entry.startswith("#"), f"not a pin: {entry[:80]}"
        if found:
            pins.setdefault(found[1], []).append(entry)
    return pins


@pytest.mark.parametrize("host", REGISTRY_HOSTS)
def test_no_tracked_file_names_a_package_registry(tracked_texts: dict[str, str], host: str) -> None:
    assert [name for name, text in tracked_texts.items() if host in text] == []


def test_no_tracked_file_holds_a_path_of_one_machine(tracked_texts: dict[str, str]) -> None:
    found = {name: MACHINE_PATH.search(text) for name, text in tracked_texts.items()}
    assert {name: match[0] for name, match in found.items() if match} == {}


def test_every_pin_has_hashes(pins: dict[str, list[str]]) -> None:
    assert len(pins) > 20
    entries = [entry for entries in pins.values() for entry in entries]
    assert [entry for entry in entries if "--hash=sha256:" not in entry] == []


def test_the_lock_pins_every_dependency(
    project: dict[str, Any], pins: dict[str, list[str]]
) -> None:
    requirements = [
        *project["project"]["dependencies"],
        *(name for extra in project["project"]["optional-dependencies"].values() for name in extra),
        *(name for group in project["dependency-groups"].values() for name in group),
    ]
    names = {re.split(r"[^A-Za-z0-9._-]", requirement)[0] for requirement in requirements}
    assert names - pins.keys() == set()


def test_the_light_install_is_a_part_of_the_whole(
    repository: Path, project: dict[str, Any], pins: dict[str, list[str]]
) -> None:
    light = project["dependency-groups"]["light"]
    assert set(light) < set(project["project"]["dependencies"])
    pinned = pins_in(repository / "requirements-light.lock")
    assert {re.split(r"[^A-Za-z0-9._-]", requirement)[0] for requirement in light} <= set(pinned)
    assert {"numba", "plotly", "pyarrow", "pycolmap"} & set(pinned) == set()
    for name, entries in pinned.items():
        versions = {entry.split()[0] for entry in entries}
        assert versions == {entry.split()[0] for entry in pins[name]}
        assert [entry for entry in entries if "--hash=sha256:" not in entry] == []


def test_versions_agree(repository: Path, project: dict[str, Any]) -> None:
    version = project["project"]["version"]
    citation = (repository / "CITATION.cff").read_text(encoding="utf-8")
    changelog = (repository / "CHANGELOG.md").read_text(encoding="utf-8")
    assert importlib.metadata.version("aerocues") == version
    assert re.search(r"^version: (.+)$", citation, re.MULTILINE)[1] == version  # type: ignore[index]
    assert "[Unreleased]" in changelog or f"[{version}]" in changelog


def test_the_continuous_check_uses_targets_that_exist(repository: Path) -> None:
    makefile = (repository / "Makefile").read_text()
    script = (repository / ".ci" / "run").read_text()
    targets = set(re.findall(r"^([a-z-]+):", makefile, re.MULTILINE))
    used = set(re.findall(r"\bmake --silent ([a-z-]+)", script))
    assert {"setup", "demo", "test", "lint", "bench"} <= targets
    assert used
    assert used <= targets


def test_every_package_has_its_place_in_the_guide(
    repository: Path, project: dict[str, Any]
) -> None:
    [contract] = [
        each for each in project["tool"]["importlinter"]["contracts"] if each["type"] == "layers"
    ]
    source = repository / "src" / "aerocues"
    layers = [name for layer in contract["layers"] for name in layer.split(" | ")]
    packages = [name for name in layers if (source / name).is_dir()]
    table = (repository / "CONTRIBUTING.md").read_text(encoding="utf-8")
    rows = "".join(re.findall(r"^\| (`.*?) \|", table, re.MULTILINE))
    assert [name for name in re.findall(r"`(\w+)`", rows) if name in packages] == packages
    picture = (repository / "docs" / "architecture.svg").read_text(encoding="utf-8")
    drawn = re.findall(r'font-weight="650".*?>(\w+)<', picture.rpartition("Which package")[2])
    assert [name for name in drawn if name in packages] == packages


def test_what_the_demo_leaves_is_removed(repository: Path) -> None:
    asked = ["make", "--dry-run", "clean"]
    removed = subprocess.run(asked, cwd=repository, capture_output=True, text=True, check=True)
    left = re.findall(r"^/(demo-[a-z.-]+)", (repository / ".gitignore").read_text(), re.MULTILINE)
    assert left
    assert {name.rstrip("/") for name in left} <= set(removed.stdout.split())


def test_source_files_stay_readable(tracked_texts: dict[str, str]) -> None:
    sources = {
        name: text for name, text in tracked_texts.items() if re.match(r"src/.*\.(?:py|js)$", name)
    }
    too_long = {
        name: text.count("\n")
        for name, text in sources.items()
        if text.count("\n") > LONGEST_SOURCE_FILE
    }
    vague = [
        name
        for name in sources
        if re.search(r"/(?:utils?|helpers?|common|misc|manager|core)(?:\.py|/)", name)
    ]
    assert too_long == {}
    assert vague == []


def test_importing_the_package_loads_nothing_heavy() -> None:
    code = "import aerocues, aerocues.cli, sys; print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(run.stdout.split())
    assert loaded & set(HEAVY_MODULES) == set()
