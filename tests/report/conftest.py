"""Results to report on, and a browser with nothing of the network in reach that opens reports."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import aerocues
from aerocues import Results
from aerocues.report.page import page_of
from tests.cli.conftest import shared_views
from tests.made_once import made_once
from tests.report.made_up import failed, folder_of, measured
from tests.report.small_payload import small_payload

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, Request

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
OF_THE_PAGE = ("file:", "data:", "blob:")
RUN_COMBINATIONS = "ORB-ORB-HAM-BF,AKAZE-AKAZE-HAM-BF,GFTT-BRIEF-HAM-FLANN,SIFT-SIFT-L2-BF"


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What a browser does takes seconds."""
    for item in items:
        if "browser" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.slow)


@dataclass
class Opened:
    """An open report, and what went wrong in it."""

    page: Page
    faults: list[str] = field(default_factory=list)

    def figure(self, name: str) -> None:
        """Scroll to a figure and wait until it is drawn."""
        self.page.locator(f"#figure-{name}").scroll_into_view_if_needed()
        self.page.wait_for_selector(f"#figure-{name} .main-svg, #figure-{name} .nothing")

    def fragment(self) -> str:
        """What stands behind the # of the address."""
        return str(self.page.evaluate("location.hash.slice(1)"))

    def rows(self) -> list[str]:
        """Names of the combinations in the table, in order."""
        return self.page.locator("#ranking tbody th").all_inner_texts()


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Chromium, without a window."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    program = next((found for name in BROWSERS if (found := shutil.which(name))), None)
    if program is None:
        pytest.skip("no Chromium; install it to test the page of the report")
    # Its sandbox needs rights that the superuser of a container lacks.
    arguments = ["--no-sandbox"] if os.geteuid() == 0 else []
    with sync_api.sync_playwright() as playwright:
        launched = playwright.chromium.launch(executable_path=program, args=arguments)
        yield launched
        launched.close()


@pytest.fixture(scope="session")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of a small report."""
    return written(small_payload(), tmp_path_factory.mktemp("report") / "report.html")


def written(payload: dict[str, Any], path: Path) -> Path:
    """A payload as a page in a file."""
    path.write_text(page_of(json.loads(json.dumps(payload))), encoding="utf-8")
    return path


@pytest.fixture
def open_report(browser: Browser, report: Path) -> Iterator[Callable[..., Opened]]:
    """Opens reports; at the end none may have failed, or asked for anything outside its file."""
    all_opened: list[Opened] = []

    def open_one(
        fragment: str = "", file: Path | None = None, *, plotly: bool = True, **context: Any
    ) -> Opened:
        settings = {"viewport": {"width": 1280, "height": 900}, "accept_downloads": True}
        page = browser.new_context(**{**settings, **context}).new_page()
        if not plotly:  # two of three seconds of a page go into its figures
            page.add_init_script("delete window.DecompressionStream")
        opened = Opened(page)
        page.on("pageerror", lambda error: opened.faults.append(f"error: {error}"))
        page.on(
            "console",
            lambda message: (
                opened.faults.append(f"{message.type}: {message.text}")
                if message.type in ("error", "warning")
                else None
            ),
        )
        page.on("request", lambda request: _note_request(opened, request))
        page.goto(f"{(file or report).as_uri()}{fragment}")
        all_opened.append(opened)
        return opened

    yield open_one
    for opened in all_opened:
        opened.page.context.close()
    assert [fault for opened in all_opened for fault in opened.faults] == []


def _note_request(opened: Opened, request: Request) -> None:
    if not request.url.startswith(OF_THE_PAGE):
        opened.faults.append(f"request: {request.url}")


@pytest.fixture(scope="session")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """Made-up results of 5 combinations on 6 pairs; one failed on a pair, one found chance."""
    rows = measured()
    rows[7] = failed(rows[7])
    rows[13] |= {"status": "chance"}
    return folder_of(rows, tmp_path_factory.mktemp("flight"))


@pytest.fixture(scope="session")
def two_machines(tmp_path_factory: pytest.TempPathFactory) -> list[Results]:
    """The same data set on two machines."""
    return [
        folder_of(measured(machine=name, seed=seed), tmp_path_factory.mktemp(name))
        for seed, name in enumerate(("desk", "board"))
    ]


@pytest.fixture(scope="session")
def photos(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of four overlapping images: three pairs."""
    return shared_views(tmp_path_factory)


@pytest.fixture(scope="session")
def finished(photos: Path, tmp_path_factory: pytest.TempPathFactory) -> Results:
    """A finished run of 4 combinations on the 3 pairs of `photos`."""

    def make(folder: Path) -> None:
        aerocues.run(str(photos), RUN_COMBINATIONS, folder, workers=1)

    return Results(made_once(tmp_path_factory, "results-of-reports", make)[0])
