"""What runs beside a submission, a folder a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from grader.scenes.scene import Scene


def load_scene(name: str) -> Scene:
    """The scene of this name.

    Raises:
        KeyError: there is none.
    """
    # here: what examines a package sees little of the grader
    from grader.recording.subject import load_subject
    from grader.scenes.scene import Scene

    scene = load_subject(name)
    if not isinstance(scene, Scene):
        raise KeyError(f"{name!r} is no scene: nothing runs beside a submission")
    return scene
