"""The line of the page that is served while a command works."""

from __future__ import annotations

from aerocues.cli.progress import Tally
from aerocues.cli.serving import told
from aerocues.progress import Event


def test_the_line_tells_the_stage_and_how_things_stand() -> None:
    tally = Tally(clock=lambda: 45_000.0)
    assert told(tally) == "starting"
    tally(Event("racing", standing="ORB leads (61%)"))
    assert told(tally) == "racing: ORB leads (61%)"
    tally(Event("surveying"))
    assert told(tally).startswith("surveying, ")
