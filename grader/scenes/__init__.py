"""Scenes, which run beside a submission: a folder each."""

from __future__ import annotations

from grader.recording.subject import load_subject
from grader.scenes.scene import Scene


def load_scene(name: str) -> Scene:
    """Load the scene of this name.

    Raises:
        KeyError: there is none.
    """
    scene = load_subject(name)
    if not isinstance(scene, Scene):
        raise KeyError(f"{name!r} is no scene: nothing runs beside a submission")
    return scene
