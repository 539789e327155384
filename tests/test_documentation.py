"""What the guide says is true: commands and programs in it run, tables and links are right."""

from __future__ import annotations

import contextlib
import os
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from numpy.typing import NDArray

import aerocues
from docs.notebook_pages import EXAMPLES, page_of
from docs.tables import TABLES, rendered
from tests.evaluation.cluster import Cluster
from tests.preloaded import Preloaded

if TYPE_CHECKING:
    from PIL import Image

REPOSITORY = Path(__file__).resolve().parent.parent
PAGES = [REPOSITORY / "README.md", *sorted((REPOSITORY / "docs").glob("*.md"))]
FENCE = re.compile(r"^```(\w+)(?: ([^\n]*))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)\s]+)\)")
SHELLS = ("console", "bash")
FOR_THE_SHELL = re.compile(r"[|&;<>$*?~]|^(?!aerocues )")
CHOICE = re.compile(r" --(combinations|detectors|descriptors) ")
TWO_METHODS = " --combinations 'ORB-ORB-HAM-*,AKAZE-AKAZE-HAM-*'"
FEWER = {"ORB-*-HAM-BF": "ORB-BR*-HAM-BF,ORB-ORB-HAM-BF", "EDGES-*-*-BF": "EDGES-SIFT-L2-BF"}


@dataclass(frozen=True)
class Block:
    """A fenced block of a page: its language, the rest of its first line, and its text."""

    language: str
    note: str
    text: str

    @property
    def file_name(self) -> str | None:
        """The file that the block shows whole, if it says so: ``title="NAME"``."""
        found = re.search(r'title="([^"]+)"', self.note)
        return found[1] if found else None

    def commands(self) -> Iterator[tuple[str, str]]:
        """Each command of ours, and the output that the page shows for it."""
        lines = self.text.replace("\\\n", " ").splitlines()
        prompt = "$ " if self.language == "console" else ""
        starts = [number for number, line in enumerate(lines) if line.startswith(prompt)]
        for start, end in zip(starts, [*starts[1:], len(lines)], strict=True):
            command = lines[start].removeprefix(prompt)
            if command.split()[:1] in (["aerocues"], ["make"]):
                yield command, "\n".join(lines[start + 1 : end])


def blocks(page: Path) -> list[Block]:
    text = page.read_text(encoding="utf-8")
    return [Block(mark[1], mark[2] or "", mark[3]) for mark in FENCE.finditer(text)]


def commands_of(page: Path) -> list[str]:
    shells = (block for block in blocks(page) if block.language in SHELLS)
    return [command for block in shells for command, _ in block.commands()]


def identify(page: Path) -> str:
    return page.name


ALL_COMMANDS = sorted({command for page in PAGES for command in commands_of(page)})


@pytest.mark.parametrize("page", sorted(TABLES))
def test_tables_follow_the_source(page: str) -> None:
    text = (REPOSITORY / "docs" / page).read_text(encoding="utf-8")
    assert text == rendered(page), "out of date; run: make tables"


def anchors(page: Path) -> set[str]:
    titles = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title).lower().replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", [*PAGES, REPOSITORY / "CONTRIBUTING.md"], ids=identify)
def test_links_between_pages_lead_somewhere(page: Path) -> None:
    for target in LINK.findall(page.read_text(encoding="utf-8")):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        other = page.parent / name if name else page
        assert other.exists(), f"{page.name} links to {target}"
        if anchor:
            assert anchor in anchors(other), f"{page.name} links to {target}"


def test_the_site_has_every_page_and_every_public_name() -> None:
    navigation = (REPOSITORY / "mkdocs.yml").read_text(encoding="utf-8")
    listed = set(re.findall(r"(\w+\.md)$", navigation, re.MULTILINE))
    notebooks = {f"{notebook.stem}.md" for notebook in EXAMPLES.glob("*.ipynb")}
    assert listed == {page.name for page in PAGES[1:]} | notebooks
    reference = (REPOSITORY / "docs" / "api.md").read_text(encoding="utf-8")
    names = re.findall(r"^::: (aerocues\.[\w.]+)\.(\w+)$", reference, re.MULTILINE)
    assert {name for _, name in names} == set(aerocues.__all__) - {"__version__"}
    assert all(getattr(aerocues, name).__module__ == module for module, name in names)


@pytest.mark.parametrize("notebook", ["my_photos", "my_descriptor"])
def test_a_notebook_is_a_page_with_its_outputs(notebook: str) -> None:
    page = page_of(EXAMPLES / f"{notebook}.ipynb")
    assert page.count("```python\n") > 6
    assert "data:image/jpeg;base64," in page
    assert "Plotly.newPlot" in page
    assert "<table" in page
    for target in LINK.findall(page):
        assert (REPOSITORY / "docs" / target.partition("#")[0]).exists(), target


@pytest.mark.parametrize("command", [one for one in ALL_COMMANDS if one.startswith("make")])
def test_targets_exist(command: str) -> None:
    makefile = (REPOSITORY / "Makefile").read_text(encoding="utf-8")
    targets = [word for word in shlex.split(command)[1:] if "=" not in word]
    for target in targets:
        assert re.search(rf"^{target}:", makefile, re.MULTILINE), f"make {target}"


@pytest.fixture(scope="module")
def help_of() -> dict[tuple[str, ...], str]:
    """The help of each command that the guide shows, asked for once."""
    return {}


@pytest.mark.parametrize("command", [one for one in ALL_COMMANDS if one.startswith("aerocues")])
def test_options_exist(
    command: str, help_of: dict[tuple[str, ...], str], preloaded: Preloaded
) -> None:
    words = shlex.split(command.split("|", maxsplit=1)[0])[1:]
    depth = 2 if words[0] in ("datasets", "methods") and len(words) > 1 else 1
    path = tuple(word for word in words[:depth] if not word.startswith("-"))
    if path not in help_of:
        asked = run_aerocues(preloaded, *path, "--help")
        assert asked.returncode == 0, asked.stderr
        help_of[path] = re.sub(r"\x1b\[[0-9;]*m", "", asked.stdout)
    known = set(re.findall(r"(?<![\w-])--?[a-z][a-z-]*", help_of[path]))
    used = {word for word in words if re.match(r"--?[a-z]", word)}
    assert used - known == set()


def run_aerocues(preloaded: Preloaded, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "COLUMNS": "200", "NO_COLOR": "1"}
    return preloaded.run(["aerocues", *arguments], REPOSITORY, environment)


def scene(seed: int) -> NDArray[np.uint8]:
    """A coloured picture with corners and blobs at several sizes."""
    generator = np.random.default_rng(seed)
    picture = np.full((280, 360, 3), 110, np.float64)
    for _ in range(260):
        y, x = generator.integers(0, (270, 350))
        height, width = generator.integers(4, 34, 2)
        picture[y : y + height, x : x + width] = generator.integers(20, 236, 3)
    picture += generator.normal(0, 2, picture.shape)
    return np.clip(picture, 0, 255).astype(np.uint8)


def write_view(path: Path, picture: NDArray[np.uint8], shift: int, exif: bytes = b"") -> None:
    """Write the part of a picture that a camera moved by `shift` pixels sees."""
    from PIL import Image

    path.parent.mkdir(parents=True, exist_ok=True)
    view = np.ascontiguousarray(picture[shift : shift + 200, shift : shift + 260])
    Image.fromarray(view).save(path, exif=exif)


def focal_length(exif: Image.Exif) -> bytes:
    """The same EXIF data with a focal length of 24 mm on 35 mm film."""
    exif[0x8769] = {0xA405: 24}
    return exif.tobytes()


def gps(latitude: float) -> bytes:
    """EXIF data with a position and a focal length."""
    from PIL import Image

    degrees = int(latitude)
    minutes = (latitude - degrees) * 60
    exif = Image.Exif()
    exif[0x8825] = {1: "N", 2: (degrees, minutes, 0.0), 3: "E", 4: (35.0, 19.0, 0.0), 6: 150.0}
    return focal_length(exif)


def write_stand_in_data(folder: Path) -> None:
    """Small images under every name that the guide uses for images."""
    from PIL import Image

    for shift, name in ((0, "a.png"), (9, "b.png")):
        write_view(folder / "photos" / name, scene(1), shift, focal_length(Image.Exif()))
    for number in range(3):
        position = gps(37.05 + number * 0.0002)
        write_view(folder / "flight" / f"{number}.jpg", scene(2), 8 * number, position)
    for number, project in enumerate(("beach", "quarry")):
        for shift, name in ((0, "1.jpg"), (10, "2.jpg")):
            write_view(folder / "projects" / project / name, scene(3 + number), shift)
    for number in range(6):
        shift = 6 * number
        moved = f"1 0 {-shift}\n0 1 {-shift}\n0 0 1\n"
        write_view(folder / "oxford" / "graf" / f"img{number + 1}.png", scene(5), shift)
        write_view(folder / "hpatches" / "v_wall" / f"{number + 1}.png", scene(6), shift)
        if number:
            (folder / "oxford" / "graf" / f"H1to{number + 1}p").write_text(moved)
            (folder / "hpatches" / "v_wall" / f"H_1_{number + 1}").write_text(moved)
    (folder / "pairs.txt").write_text("a.png b.png\n")


@pytest.fixture(scope="module")
def preloaded() -> Iterator[Preloaded]:
    """What runs our own programs."""
    with Preloaded() as process:
        yield process


def environment_in(folder: Path) -> dict[str, str]:
    """That of a reader, with what pip installed into `folder` in reach."""
    return {
        **os.environ,
        "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]),
        "PYTHONPATH": os.pathsep.join(
            filter(None, (str(folder / "installed"), os.environ.get("PYTHONPATH")))
        ),
        "COLUMNS": "100",
        "NO_COLOR": "1",
    }


def run_in(folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    """Run a command as a reader would."""
    return subprocess.run(
        command,
        cwd=folder,
        env=environment_in(folder),
        capture_output=True,
        text=True,
        check=False,
    )


def run_line(folder: Path, line: str, preloaded: Preloaded) -> subprocess.CompletedProcess[str]:
    """Run a line of a shell, which itself is needed only for what has a meaning to it alone."""
    if FOR_THE_SHELL.search(re.sub("'[^']*'|\"[^\"]*\"", "", line)):
        return run_in(folder, "bash", "-o", "pipefail", "-c", line)
    return preloaded.run(shlex.split(line), folder, environment_in(folder))


def install(folder: Path) -> None:
    """Install the package that the blocks so far wrote into `folder`."""
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index"]
    built = run_in(folder, *pip, "--no-build-isolation", "--target", "installed", ".")
    assert built.returncode == 0, built.stderr


@contextlib.contextmanager
def cluster_of_boards(folder: Path) -> Iterator[str]:
    """The address of a cluster with one worker, which is a board."""
    pytest.importorskip("distributed")
    with tempfile.TemporaryDirectory(dir=folder) as own:
        cluster = Cluster(Path(own))
        try:
            cluster.start()
            cluster.add_worker("--no-nanny", "--resources", "board=1")
            yield cluster.address
        finally:
            cluster.stop()


def fewer_keypoints(command: str) -> str:
    """The same command, for fewer keypoints than the thousands that a flight is given."""
    models = re.match(
        r"aerocues (recommend|reconstruct)|aerocues use .* --as (colmap|odm|openmvg) ", command
    )
    if " --max-keypoints " in command or not models:
        return command
    return f"{command} --max-keypoints 500"


def smaller(command: str) -> str:
    """What is run in place of a command that needs the network, all methods or a share of time.

    A race of few methods ends when all is measured, however fast the machine is.
    """
    if command.startswith("aerocues datasets fetch"):
        return "aerocues datasets fetch --help"
    command = re.sub(r" --budget \S+", " --budget 1h", command)
    for many, few in FEWER.items():
        command = command.replace(many, few)
    if " --from " in command and command.startswith("aerocues recommend"):
        return command  # nothing is measured
    if command.startswith("aerocues recommend"):
        command += " --no-final"
    if command.startswith("aerocues reconstruct"):
        command = re.sub(r" --top \d+", " --top 1", command) + " --no-baseline"
    command = fewer_keypoints(command)
    if command.startswith("aerocues run simulated:"):
        command += " --max-pairs 2"
    if command.startswith(("aerocues run", "aerocues recommend")) and not CHOICE.search(command):
        command += TWO_METHODS
    if command.startswith("aerocues run ") and not re.search(
        " --(timing|timing-pairs|engine) ", command
    ):
        command += " --timing shared --workers 1"
    return command


def run_command(
    folder: Path, command: str, shown: str, preloaded: Preloaded, *, exact: bool
) -> None:
    if command.startswith("make"):
        return
    command = smaller(command)
    with contextlib.ExitStack() as running:
        if "--engine dask" in command:
            address = running.enter_context(cluster_of_boards(folder))
            command = re.sub(r"--scheduler \S+", f"--scheduler {address}", command)
        done = run_line(folder, command, preloaded)
    # The stand-in views are too much alike for a model, which `reconstruct` ends with 1 for.
    no_model = "no combination reconstructs the flight correctly" in done.stdout
    expected = 1 if command.startswith("aerocues reconstruct") and no_model else 0
    assert done.returncode == expected, f"{command}\n{done.stdout}\n{done.stderr}"
    if exact:
        assert done.stdout.split() == shown.split(), command


# The thesis's page needs its measurements: tests/test_thesis.py runs it. What learned.md shows
# needs aerocues-learned, whose own tests read the page. tests/cli/test_study_page.py runs that of
# the study.
NOT_RUN = ("thesis.md", "learned.md", "study.md")
RUN = [page for page in PAGES if blocks(page) and page.name not in NOT_RUN]


@pytest.mark.slow
@pytest.mark.parametrize("page", RUN, ids=identify)
def test_the_page_runs_from_top_to_bottom(page: Path, tmp_path: Path, preloaded: Preloaded) -> None:
    write_stand_in_data(tmp_path)
    for block in blocks(page):
        if block.file_name:
            (tmp_path / block.file_name).write_text(block.text, encoding="utf-8")
            if (tmp_path / "pyproject.toml").exists() and block.language == "python":
                install(tmp_path)
        elif block.language == "python":
            (tmp_path / "program.py").write_text(block.text, encoding="utf-8")
            program = ("python", "program.py")
            done = preloaded.run(program, tmp_path, environment_in(tmp_path))
            assert done.returncode == 0, f"{block.text}\n{done.stdout}\n{done.stderr}"
        elif block.language in SHELLS:
            for command, shown in block.commands():
                run_command(tmp_path, command, shown, preloaded, exact="exact" in block.note)


@pytest.mark.slow
def test_the_demonstration_ends_in_a_table_and_a_report(tmp_path: Path) -> None:
    names = {"FLIGHT": "flight", "RESULTS": "results", "MODELS": "models", "REPORT": "report.html"}
    variables = [f"DEMO_{name}={tmp_path / path}" for name, path in names.items()]
    # Other tests run every method; here a few quick ones do, as thousands of keypoints are matched.
    variables += ["DEMO_SIZE=350x233", "DEMO_COMBINATIONS=ORB-ORB-HAM-EXACT,AKAZE-AKAZE-HAM-EXACT"]
    done = subprocess.run(
        ["make", "--silent", "demo", *variables],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "COLUMNS": "160", "NO_COLOR": "1"},
    )
    assert done.returncode == 0, done.stderr
    last_lines = "\n".join(done.stdout.splitlines()[-40:])
    assert re.search(r"[A-Z_]+-[A-Z_]+-(?:L2|HAM)-EXACT", last_lines)
    assert str(tmp_path / "report.html") in last_lines
    assert (tmp_path / "report.html").is_file()
