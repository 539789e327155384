"""What a race leaves of its features."""

from __future__ import annotations

import shutil
from pathlib import Path
from types import SimpleNamespace

import pytest

from aerocues.tuning.kept_features import LEAST_FREE, MOST_KINDS, has_room, keep_best


def test_features_of_the_best_stay_with_their_keypoints(tmp_path: Path) -> None:
    kinds = [f"ORB-{name}" for name in ("ORB", "BRIEF", "TEBLID")]
    kinds += [f"{name}-SIFT" for name in ("SIFT", "STAR", "AKAZE", "GFTT", "KAZE", "MSD")]
    for place in (*kinds, *(kind.split("-")[0] for kind in kinds), "FAST"):
        (tmp_path / place).mkdir(exist_ok=True)
        (tmp_path / place / "key.npz").touch()
    # The same kind with two matchers counts once.
    ranked = [f"{kind}-L2-{matcher}" for kind in kinds for matcher in ("BF", "EXACT")]
    assert len(kinds) == MOST_KINDS + 1
    keep_best(tmp_path, ranked)
    gone = {"MSD-SIFT", "MSD", "FAST"}
    left = {place.name for place in tmp_path.iterdir()}
    assert left == {*kinds, *(kind.split("-")[0] for kind in kinds)} - gone


@pytest.mark.parametrize(("free", "room"), [(LEAST_FREE, True), (LEAST_FREE - 1, False)])
def test_a_nearly_full_disk_has_no_room(
    free: int, room: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    usage = SimpleNamespace(total=2 * LEAST_FREE, used=0, free=free)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage)
    assert has_room(tmp_path) is room
