"""The process that reconstructs: ``python -m aerocues.reconstruction.worker``.

It receives a scene and then images to prepare, a combination, or matches or links to find, and
sends back the result. COLMAP can abort its process; then only this work is lost.
"""

from __future__ import annotations

from multiprocessing.connection import Connection

from aerocues.methods.combination import Combination
from aerocues.processes.child import run_child
from aerocues.processes.heartbeat import Heartbeat


def serve(pipe: Connection, heartbeat: Heartbeat) -> None:
    """Process one task after the other until the parent closes the pipe."""
    from aerocues.errors import AerocuesError
    from aerocues.reconstruction.baseline import BaselineModel
    from aerocues.reconstruction.colmap import quiet
    from aerocues.reconstruction.combination_model import CombinationModel
    from aerocues.reconstruction.images import prepare_image
    from aerocues.reconstruction.linked_scene import LinkMaker
    from aerocues.reconstruction.matching import Links, Matching
    from aerocues.results.reconstruction_schema import BASELINE

    scene = pipe.recv()
    quiet()
    pipe.send("ready")
    while True:
        try:
            work = pipe.recv()
        except EOFError:
            return
        try:
            if isinstance(work, Combination):
                maker = BaselineModel if work == BASELINE else CombinationModel
                found: object = maker(scene, work, heartbeat.announce).make()
            elif isinstance(work, Matching):
                found = CombinationModel(scene, work.combination, heartbeat.announce).match_ahead()
            elif isinstance(work, Links):
                found = LinkMaker(scene, work.combination, heartbeat.announce).make()
            else:
                found = prepare_image(scene.dataset.image(work), scene.images)
        except (AerocuesError, OSError) as error:
            found = error
        heartbeat.announce(None)
        pipe.send(found)


if __name__ == "__main__":
    run_child(serve)
