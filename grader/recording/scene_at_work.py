"""Tells the mistakes of a scene from those of a submission and of ours."""

from __future__ import annotations

import signal
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import Any, Final

from grader.errors import SceneFailure
from grader.text.message import msg
from grader.text.strings import shown

#: What stands in for rclpy's middleware in virtual time.
STAND_IN: Final = Path(__file__).parents[1] / "run" / "lockstep"
#: So much of what a scene raises or returns is shown [characters].
LONGEST_WORDS: Final = 300


class Overdue(BaseException):
    """A scene has not returned in time; no `except Exception` of its own catches it."""


def overdue(*_: object) -> None:
    """Handle the alarm of `scene_at_work`."""
    raise Overdue("it did not return")


@contextmanager
def scene_at_work(scene: str, *may_raise: type[Exception], within_s: float = 0.0) -> Iterator[None]:
    """Raise a `SceneFailure` for an exception of a scene's own code, but for what it may raise.

    Also where that takes longer than `within_s` [s], where `overdue` handles SIGALRM; 0: no limit.
    A lack of memory, and what rclpy or its stand-in raises, may be the submission's doing or ours.
    """
    passed: tuple[type[Exception], ...] = (SceneFailure, *may_raise)  # one hook calls another
    try:
        if within_s:
            signal.setitimer(signal.ITIMER_REAL, within_s, within_s)
        yield
    except passed:
        raise
    except (Exception, SystemExit, Overdue) as error:
        is_overdue = isinstance(error, Overdue)  # then the last place is the alarm's handler
        place = traceback.extract_tb(error.__traceback__)[-1 - is_overdue]
        is_of_rclpy = type(error).__module__.startswith("rclpy._")
        is_stand_in = STAND_IN in Path(place.filename).parents and not is_overdue
        if is_of_rclpy or is_stand_in or isinstance(error, MemoryError):
            raise
        where = {"file": Path(place.filename).name, "line": str(place.lineno)}
        what = shown(f"{type(error).__name__}: {error}", LONGEST_WORDS)
        raised = msg(
            "the scene {scene} raised {what} ({file}, line {line})", scene=scene, what=what, **where
        )
        raise SceneFailure(raised) from error
    finally:
        if within_s:
            signal.setitimer(signal.ITIMER_REAL, 0)


def at_work(hook: Callable[..., Any], *may_raise: type[Exception]) -> Callable[..., Any]:
    """Return a hook of a subject that raises a `SceneFailure` for all but what it may raise."""

    @wraps(hook)
    def named(self: Any, *args: Any, **words: Any) -> Any:
        with scene_at_work(self.name, *may_raise):
            return hook(self, *args, **words)

    return named
