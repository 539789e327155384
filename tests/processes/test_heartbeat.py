from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aerocues.processes.call import StageCall
from aerocues.processes.heartbeat import SIZE, Heartbeat


def page(folder: Path) -> Path:
    path = folder / "heartbeat"
    path.touch()
    return path


def test_the_reader_sees_what_the_writer_announced_last(tmp_path: Path) -> None:
    path = page(tmp_path)
    writer, reader = Heartbeat(path), Heartbeat(path)
    first = reader.read()
    assert first is not None
    assert first.call is None
    call = StageCall("describe", 3, "größe/図.png", "ORB", "FREAK", "ORB-FREAK-HAM-BF")
    writer.announce(call)
    beat = reader.read()
    assert beat is not None
    assert beat.call == call
    assert beat.number == 1
    assert beat.cpu_seconds > 0
    assert beat.wall_time > 0
    writer.announce(None)
    beat = reader.read()
    assert beat is not None
    assert beat.call is None
    assert beat.number == 2
    writer.close()
    assert reader.read() == beat


def test_a_shorter_announcement_leaves_nothing_of_a_longer_one(tmp_path: Path) -> None:
    path = page(tmp_path)
    writer, reader = Heartbeat(path), Heartbeat(path)
    writer.announce(StageCall("match", 1, "x" * 900, "SIFT", "SIFT", "SIFT-SIFT-L2-BF"))
    short = StageCall("detect", 2, "a", "ORB")
    writer.announce(short)
    beat = reader.read()
    assert beat is not None
    assert beat.call == short


def test_a_torn_page_is_not_read(tmp_path: Path) -> None:
    path = page(tmp_path)
    writer, reader = Heartbeat(path), Heartbeat(path)
    writer.announce(StageCall("detect", 2, "a", "ORB"))
    content = bytearray(path.read_bytes())
    content[:8] = (7).to_bytes(8, "little")
    with path.open("r+b") as file:
        file.write(content)
    assert reader.read() is None


@pytest.mark.slow
@given(st.text(max_size=3 * SIZE))
def test_names_of_any_length_do_no_harm(name: str) -> None:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        heartbeat = Heartbeat(page(Path(folder)))
        heartbeat.announce(StageCall("detect", 0, name, "ORB"))
        beat = heartbeat.read()
        assert beat is not None
        assert beat.call is None or beat.call.image == name
        heartbeat.close()


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (StageCall("detect", 0, "a.png", "ORB"), "detect ORB on a.png"),
        (StageCall("describe", 0, "a.png", "ORB", "FREAK"), "describe ORB-FREAK on a.png"),
        (
            StageCall("match", 0, "a.png and b.png", "ORB", "ORB", "ORB-ORB-HAM-BF"),
            "match ORB-ORB-HAM-BF on a.png and b.png",
        ),
    ],
)
def test_a_call_names_its_method_and_image(call: StageCall, text: str) -> None:
    assert str(call) == text
