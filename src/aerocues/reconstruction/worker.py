"""The process that reconstructs: ``python -m aerocues.reconstruction.worker``.

It receives a scene and then images to prepare, a combination, or matches or links to find, and
sends back the result. COLMAP can abort its process; then only this work is lost.
"""

from __future__ import annotations

from multiprocessing.connection import Connection

from aerocues.errors import AerocuesError
from aerocues.methods.combination import Combination
from aerocues.pipeline.feature_source import Announce
from aerocues.processes.child import run_child
from aerocues.processes.heartbeat import Heartbeat
from aerocues.reconstruction.matching import Links, Matching
from aerocues.reconstruction.scene import Scene
from aerocues.results.reconstruction_schema import BASELINE


def _done(scene: Scene, work: object, announce: Announce) -> object:
    """The result of one task; it imports no more than the task needs, which can take a second."""
    if isinstance(work, str):
        from aerocues.reconstruction.images import prepare_image

        return prepare_image(scene.dataset.image(work), scene.images)
    from aerocues.reconstruction.colmap import quiet

    quiet()
    if isinstance(work, Links):
        from aerocues.reconstruction.linked_scene import LinkMaker

        return LinkMaker(scene, work.combination, announce).make()
    if work == BASELINE:
        from aerocues.reconstruction.baseline import BaselineModel

        return BaselineModel(scene, work, announce).make()
    from aerocues.reconstruction.combination_model import CombinationModel

    if isinstance(work, Matching):
        return CombinationModel(scene, work.combination, announce).match_ahead()
    assert isinstance(work, Combination)
    return CombinationModel(scene, work, announce).make()


def serve(pipe: Connection, heartbeat: Heartbeat) -> None:
    """Process one task after the other until the parent closes the pipe."""
    scene = pipe.recv()
    pipe.send("ready")
    while True:
        try:
            work = pipe.recv()
        except EOFError:
            return
        try:
            found = _done(scene, work, heartbeat.announce)
        except (AerocuesError, OSError) as error:
            found = error
        heartbeat.announce(None)
        pipe.send(found)


if __name__ == "__main__":
    run_child(serve)
