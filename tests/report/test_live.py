"""The page that is served while a command fills its folder."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from http.client import HTTPConnection
from pathlib import Path

from aerocues.errors import ScoreError
from aerocues.progress import Event
from aerocues.report.live import HOST, SECONDS_BETWEEN_PAGES, LivePage, Serving, page_of_folder
from aerocues.tuning.journal import record_answer
from tests.report.decoding import payload_in
from tests.report.made_up import COMBINATIONS, folder_of, measured
from tests.report.small_payload import RACE

PAGE = """<meta content="default-src 'none'; img-src data:"><body>made</body>"""


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


def finished(rows: int, stage: str = "measuring") -> Event:
    return Event(stage, "rows", rows, 10, rows=({"status": "ok"},))


def test_a_page_is_made_where_there_are_new_rows_and_seldom() -> None:
    clock, folders = Clock(), []

    def make(folder: Path) -> str:
        folders.append(folder)
        clock.now += 2.0
        return PAGE

    live = LivePage(Path("results"), make, clock, clock)
    assert not live.refresh()
    live(finished(1))
    assert live.refresh()
    assert (live.made, folders) == (1, [Path("results")])
    clock.now += SECONDS_BETWEEN_PAGES
    live(finished(2))
    assert not live.refresh()
    # It took 2 s: nine tenths of the time belong to the work.
    clock.now += 20
    assert live.refresh()
    clock.now += 60
    assert not live.refresh()
    live(finished(3, "timing"))
    assert not live.refresh()


def test_calls_are_timed_only_when_a_page_that_is_being_made_is_done() -> None:
    begun, go_on, order = threading.Event(), threading.Event(), []

    def make(folder: Path) -> str:
        begun.set()
        go_on.wait(60)
        order.append("made")
        return PAGE

    def measure() -> None:
        live(finished(2, "timing"))
        order.append("timing")

    live = LivePage(Path("results"), make, Clock())
    live(finished(1))
    threads = [threading.Thread(target=live.refresh), threading.Thread(target=measure)]
    threads[0].start()
    assert begun.wait(60)
    threads[1].start()
    go_on.set()
    for thread in threads:
        thread.join()
    assert order == ["made", "timing"]


def test_the_page_waits_for_rows_that_can_be_ranked_and_keeps_the_last_one() -> None:
    clock = Clock()
    pages: Iterator[str | ScoreError] = iter(
        [ScoreError("no rows < yet"), PAGE, ScoreError("a bad moment")]
    )

    def make(folder: Path) -> str:
        found = next(pages)
        if isinstance(found, ScoreError):
            raise found
        return found

    live = LivePage(Path("results"), make, clock)
    for number, shown in enumerate(("no rows &lt; yet", "made", "made")):
        live(finished(number + 1))
        assert live.refresh()
        clock.now += 60
        assert shown in live.html()
    assert live.made == 1


def test_the_page_may_ask_its_own_server_only() -> None:
    live = LivePage(Path("results"), lambda folder: PAGE, Clock())
    live(finished(1))
    live.refresh()
    assert "default-src 'none'; connect-src 'self'; img-src data:" in live.html()
    assert live.html().count("</body>") == 1
    assert "made = 1" in live.html()


def asked(serving: Serving, path: str, **headers: str) -> tuple[int, bytes]:
    connection = HTTPConnection(serving.address.split("/")[2])
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    found = answer.status, answer.read()
    connection.close()
    return found


def test_a_browser_here_gets_page_and_state_and_others_nothing() -> None:
    live = LivePage(Path("results"), lambda folder: PAGE)
    live(Event("racing", standing="ORB leads (61%)"))
    with Serving(live) as serving:
        assert serving.address.startswith(f"http://{HOST}:")
        assert b"no rows yet" in asked(serving, "/")[1]
        state = json.loads(asked(serving, "/state")[1])
        assert state == {"made": 0, "told": "racing: ORB leads (61%)"}
        assert asked(serving, "/etc")[0] == 404
        assert asked(serving, "/", Host="elsewhere.example")[0] == 403


def test_while_a_race_goes_on_the_page_shows_no_answer_of_another(tmp_path: Path) -> None:
    results = folder_of(measured(combinations=COMBINATIONS[:2], pairs=2), tmp_path)
    record_answer(results.folder, {**RACE, "dataset": "flight"})
    page = tmp_path / "page.html"
    page.write_text(page_of_folder(results.folder), encoding="utf-8")
    (entry,) = payload_in(page)["entries"]
    assert entry["dataset"] == "flight"
    assert entry["race"] is None
