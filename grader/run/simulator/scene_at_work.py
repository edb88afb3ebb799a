"""Tells the mistakes of a scene from those of a submission and of ours."""

from __future__ import annotations

import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final, get_args

from grader.errors import SceneFailure
from grader.message import msg
from grader.scenes.scene import Reason
from grader.text import without_controls

#: What stands in for rclpy's middleware in virtual time.
STAND_IN: Final = Path(__file__).parents[1] / "lockstep"
#: So much of what a scene raises or returns is shown [characters].
LONGEST_WORDS: Final = 300


@contextmanager
def scene_at_work(scene: str) -> Iterator[None]:
    """Raise a `SceneFailure` for an exception of a scene's own code.

    A lack of memory, and what rclpy or its stand-in raises, may be the submission's doing or ours.
    """
    try:
        yield
    except (Exception, SystemExit) as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        is_of_rclpy = type(error).__module__.startswith("rclpy._")
        is_stand_in = STAND_IN in Path(place.filename).parents
        if is_of_rclpy or is_stand_in or isinstance(error, MemoryError):
            raise
        where = {"file": Path(place.filename).name, "line": str(place.lineno)}
        what = without_controls(f"{type(error).__name__}: {error}", "?")[:LONGEST_WORDS]
        raised = msg(
            "the scene {scene} raised {what} ({file}, line {line})", scene=scene, what=what, **where
        )
        raise SceneFailure(raised) from error


def expect_reason(scene: str, found: Reason) -> Reason:
    """Return what a scene has returned for a tick; raise a `SceneFailure` where it is no reason."""
    if found not in (known := get_args(Reason)):
        shown = {"found": repr(found)[:LONGEST_WORDS], "known": ", ".join(map(repr, known))}
        failed = msg(
            "the scene {scene} returned {found}, expected one of {known}", scene=scene, **shown
        )
        raise SceneFailure(failed)
    return found
