"""Scenes, which run beside a submission: a folder each."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from grader.scenes.scene import Scene


def load_scene(name: str) -> Scene:
    """Load the scene of this name.

    Raises:
        KeyError: there is none.
    """
    # here: the process that examines a package has few of the grader's modules
    from grader.recording.subject import load_subject
    from grader.scenes.scene import Scene

    scene = load_subject(name)
    if not isinstance(scene, Scene):
        raise KeyError(f"{name!r} is no scene: nothing runs beside a submission")
    return scene
