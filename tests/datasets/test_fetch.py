from __future__ import annotations

import hashlib
import io
import json
import tarfile
import threading
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from aerocues.datasets import fetch as fetching
from aerocues.datasets.catalog import open_dataset
from aerocues.datasets.fetch import BENCHMARKS, CHECKSUMS, fetch
from aerocues.errors import DatasetError
from tests.datasets.servers import Site, serve

OXFORD = ("bark", "bikes", "boat", "graf", "leuven", "trees", "ubc", "wall")
Fetch = Callable[..., list[Path]]


def tar(files: dict[str, bytes]) -> bytes:
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w:gz") as archive:
        for name, content in files.items():
            entry = tarfile.TarInfo(name)
            entry.size = len(content)
            archive.addfile(entry, io.BytesIO(content))
    return stream.getvalue()


def zipped(files: dict[str, bytes]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return stream.getvalue()


def sequence(picture: NDArray[np.uint8], image: str, homography: str) -> dict[str, bytes]:
    encoded = cv2.imencode(".ppm", picture)[1].tobytes()
    files = {image.format(number): encoded for number in (1, 2)}
    return {**files, homography.format(2): b"1 0 0 0 1 0 0 0 1"}


@pytest.fixture
def site(picture: NDArray[np.uint8]) -> Site:
    """Both benchmarks, small; HPatches as its second address has it."""
    files = sequence(picture, "img{}.ppm", "H1to{}p")
    patches = {
        f"hpatches-sequences-release/{name}/{file}": content
        for name in ("i_dome", "v_wall")
        for file, content in sequence(picture, "{}.ppm", "H_1_{}").items()
    }
    return Site(
        {
            **{f"{name}.tar.gz": tar(files) for name in OXFORD},
            "hpatches-sequences-release.zip": zipped(patches),
        }
    )


@pytest.fixture
def fetch_here(site: Site, tmp_path: Path) -> Iterator[Fetch]:
    """`fetch` from the local server into tmp_path/data, without pauses."""
    server = serve(site)
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    address = f"http://127.0.0.1:{server.server_address[1]}/"

    def run(name: str, **options: object) -> list[Path]:
        settings = {"base_url": address, "pause": 0.0, **options}
        return fetch(name, tmp_path / "data", **settings)  # type: ignore[arg-type]

    yield run
    server.shutdown()
    server.server_close()
    thread.join()


def test_oxford_opens_after_fetching(fetch_here: Fetch, tmp_path: Path) -> None:
    folders = fetch_here("oxford")
    assert [folder.name for folder in folders] == list(OXFORD)
    dataset = open_dataset(f"oxford:{tmp_path / 'data'}")
    assert [p.sequence for p in dataset.pairs] == list(OXFORD)
    left = sorted(path.name for path in (tmp_path / "data").iterdir())
    assert left == sorted([*OXFORD, CHECKSUMS])


def test_hpatches_falls_back_to_its_second_address(fetch_here: Fetch, tmp_path: Path) -> None:
    folders = fetch_here("hpatches")
    assert [folder.name for folder in folders] == ["i_dome", "v_wall"]
    assert len(open_dataset(f"hpatches:{tmp_path / 'data'}").pairs) == 2


def test_nothing_is_fetched_twice(fetch_here: Fetch, site: Site) -> None:
    fetch_here("oxford")
    count = len(site.log)
    assert count == 8
    assert len(fetch_here("oxford")) == 8
    assert len(site.log) == count


def test_a_missing_sequence_alone_is_fetched_again(
    fetch_here: Fetch, site: Site, tmp_path: Path
) -> None:
    fetch_here("oxford")
    (tmp_path / "data" / "graf").rename(tmp_path / "elsewhere")
    fetch_here("oxford")
    assert [name for name, _ in site.log[8:]] == ["graf.tar.gz"]


def test_a_broken_transfer_goes_on_where_it_was(
    fetch_here: Fetch, site: Site, tmp_path: Path
) -> None:
    site.break_after = [1000, 500]
    fetch_here("oxford")
    assert site.log[:3] == [
        ("bark.tar.gz", None),
        ("bark.tar.gz", "bytes=1000-"),
        ("bark.tar.gz", "bytes=1500-"),
    ]
    known = json.loads((tmp_path / "data" / CHECKSUMS).read_text())["sha256"]
    assert known["bark.tar.gz"] == hashlib.sha256(site.files["bark.tar.gz"]).hexdigest()


def test_an_abandoned_download_is_resumed_by_the_next_call(fetch_here: Fetch, site: Site) -> None:
    site.break_after = [1000]
    with pytest.raises(DatasetError, match="interrupted"):
        fetch_here("oxford", attempts=1)
    fetch_here("oxford", attempts=1)
    assert site.log[1] == ("bark.tar.gz", "bytes=1000-")


def test_parts_of_two_versions_are_never_joined(
    fetch_here: Fetch, site: Site, tmp_path: Path
) -> None:
    site.break_after = [1000]
    with pytest.raises(DatasetError, match="interrupted"):
        fetch_here("oxford", attempts=1)
    site.etag = '"second"'
    site.files["bark.tar.gz"] = site.files["graf.tar.gz"] + b"\0" * 512
    fetch_here("oxford")
    known = json.loads((tmp_path / "data" / CHECKSUMS).read_text())["sha256"]
    assert known["bark.tar.gz"] == hashlib.sha256(site.files["bark.tar.gz"]).hexdigest()


def test_a_server_without_validators_starts_anew(fetch_here: Fetch, site: Site) -> None:
    site.etag = None
    site.break_after = [1000]
    fetch_here("oxford")
    assert site.log[1] == ("bark.tar.gz", None)


def test_a_part_that_is_already_whole(fetch_here: Fetch, site: Site, tmp_path: Path) -> None:
    data = tmp_path / "data"
    data.mkdir()
    (data / "bark.tar.gz.part").write_bytes(site.files["bark.tar.gz"])
    (data / "bark.tar.gz.part.validator").write_text('"first"')
    assert len(fetch_here("oxford")) == 8
    assert [wanted for _, wanted in site.log[:2]] == [
        f"bytes={len(site.files['bark.tar.gz'])}-",
        None,
    ]


def test_a_tired_server_is_asked_again_but_a_refusal_is_final(
    fetch_here: Fetch, site: Site
) -> None:
    site.failures = [503, 500]
    assert len(fetch_here("oxford")) == 8
    site.log.clear()
    del site.files["hpatches-sequences-release.zip"]
    with pytest.raises(DatasetError) as caught:
        fetch_here("hpatches")
    message = str(caught.value)
    assert "404" in message
    assert "https://huggingface.co/datasets/vbalnt/hpatches" in message
    assert "v_churchill/H_1_2" in message
    assert len(site.log) == 2


def test_a_changed_archive_is_refused(fetch_here: Fetch, site: Site, tmp_path: Path) -> None:
    fetch_here("oxford")
    (tmp_path / "data" / "graf").rename(tmp_path / "elsewhere")
    site.files["graf.tar.gz"] = tar({"img1.ppm": b"other", "H1to2p": b"other"})
    with pytest.raises(DatasetError, match=r"graf\.tar\.gz .*checksum"):
        fetch_here("oxford")
    assert not (tmp_path / "data" / "graf").exists()


def test_a_pinned_checksum_is_checked_at_once(
    fetch_here: Fetch, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = fetching.Location("https://example.org/bark.tar.gz", "0" * 64)
    pinned = fetching.Benchmark(
        "oxford", (fetching.Archive("bark", (place,)),), "H1to2p", "bark/img1.ppm"
    )
    monkeypatch.setitem(BENCHMARKS, "oxford", pinned)
    with pytest.raises(DatasetError, match="checksum 0000"):
        fetch_here("oxford")


def test_an_archive_placed_by_hand_is_used_and_kept(
    fetch_here: Fetch, site: Site, tmp_path: Path
) -> None:
    data = tmp_path / "data"
    data.mkdir()
    placed = data / "hpatches-sequences-release.zip"
    placed.write_bytes(site.files["hpatches-sequences-release.zip"])
    assert len(fetch_here("hpatches")) == 2
    assert site.log == []
    assert placed.exists()
    placed.write_bytes(b"something else")
    (data / "v_wall").rename(tmp_path / "elsewhere")
    with pytest.raises(DatasetError, match=r"hpatches-sequences-release\.zip"):
        fetch_here("hpatches")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"no archive at all", r"bark\.tar\.gz"),
        (tar({"img1.ppm": b"", "H1to2p": b""})[:-30], r"bark\.tar\.gz"),
        (tar({"readme.txt": b"hello"}), "sequence"),
        (tar({"../../evil.txt": b"", "H1to2p": b""}), "outside"),
        (tar({"/tmp/evil.txt": b"", "H1to2p": b""}), "outside"),
        (zipped({"../evil.txt": b"", "H1to2p": b""}), "outside"),
    ],
    # Archives hold the time: without names, two processes would collect different tests.
    ids=["text", "cut off", "no sequence", "above", "absolute", "above in a zip"],
)
def test_bad_archives_leave_nothing_behind(
    fetch_here: Fetch, site: Site, tmp_path: Path, content: bytes, said: str
) -> None:
    site.files["bark.tar.gz"] = content
    with pytest.raises(DatasetError, match=said):
        fetch_here("oxford")
    assert not list(tmp_path.rglob("evil.txt"))
    assert not (tmp_path / "data" / "bark").exists()
    assert not list((tmp_path / "data").glob(".unpacking*"))


def test_links_in_archives_are_passed_over(fetch_here: Fetch, site: Site, tmp_path: Path) -> None:
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w:gz") as archive:
        link = tarfile.TarInfo("img1.ppm")
        link.type, link.linkname = tarfile.SYMTYPE, "/etc/passwd"
        archive.addfile(link)
        archive.addfile(tarfile.TarInfo("H1to2p"))
    site.files["bark.tar.gz"] = stream.getvalue()
    fetch_here("oxford")
    assert [path.name for path in (tmp_path / "data" / "bark").iterdir()] == ["H1to2p"]


def test_progress_reaches_the_end(fetch_here: Fetch, site: Site) -> None:
    site.break_after = [1000]
    seen: dict[str, list[tuple[int, int | None]]] = {}
    fetch_here(
        "oxford", progress=lambda f, done, total: seen.setdefault(f, []).append((done, total))
    )
    assert set(seen) == {f"{name}.tar.gz" for name in OXFORD}
    for name, steps in seen.items():
        size = len(site.files[name])
        assert steps == sorted(steps)
        assert steps[-1] == (size, size)


def test_offline_says_what_to_put_where(tmp_path: Path) -> None:
    with pytest.raises(DatasetError) as caught:
        fetch("oxford", tmp_path, base_url="http://127.0.0.1:9", attempts=1)
    message = str(caught.value)
    for name in OXFORD:
        assert f"https://www.robots.ox.ac.uk/~vgg/research/affine/det_eval_files/{name}.tar.gz" in (
            message
        )
    assert str(tmp_path) in message
    assert "graf/img1.ppm" in message


def test_what_cannot_be_fetched(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="oxford, hpatches"):
        fetch("aerial", tmp_path)
    with pytest.raises(DatasetError, match="ftp:/x"):
        fetch("oxford", tmp_path, base_url="ftp:/x")
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(DatasetError, match=str(file)):
        fetch("oxford", file, base_url="http://127.0.0.1:9")
    (tmp_path / CHECKSUMS).write_text("{}")
    with pytest.raises(DatasetError, match=CHECKSUMS):
        fetch("oxford", tmp_path, base_url="http://127.0.0.1:9")
