"""A node that waits for something that can no longer happen, and where it does."""

from __future__ import annotations

import sys
import traceback
from dataclasses import dataclass
from types import CodeType, FrameType

from grader.run.lockstep import faults
from grader.run.student.scheduler import Scheduler
from grader.run.student.telling import Line, stack, trace

MESSAGE = """
Your node is stuck here, at {time_s:.2f} s: it waits for something that can no longer happen.
{stack}{advice}
"""
IN_CALLBACK = """\
This is a callback. While it waits, the executor can hand out no other callback of the same group:
not the answer, message or timer that it waits for. Do not wait in a callback: use call_async() and
add_done_callback(), or an `async def` callback that awaits the future."""
OUTSIDE = """\
Nobody spins this node while this call waits, so no answer, message or timer can reach it. Spin in
another thread, or use rclpy.spin_until_future_complete()."""


@dataclass(frozen=True)
class Stuck:
    """What is told of it.

    Attributes:
        text: for the author of the submission.
        kind: as in `grader.recording.conduct.Stop`.
        lines: where it is, outermost first.
    """

    text: str
    kind: str
    lines: list[Line]


def find(scheduler: Scheduler, runs_callback: CodeType, waits: frozenset[CodeType]) -> Stuck | None:
    """Describe the first thread that is stuck in a callback or in a waiting call of rclpy's.

    Args:
        scheduler: all of whose threads are blocked for good.
        runs_callback: the code of rclpy that callbacks are called from.
        waits: code of rclpy that waits for another thread to spin.

    Returns: None where threads only wait, as a program may that has done its work.
    """
    frames = sys._current_frames()
    for runner in scheduler.runners:
        lines = stack(frames.get(runner.ident))
        codes = [frame.f_code for frame, _ in lines]
        if runs_callback in codes or not waits.isdisjoint(codes):
            is_callback = runs_callback in codes
            return _stuck(lines, "callback" if is_callback else "call", scheduler.now_ns)
    return None


def find_waiting(scheduler: Scheduler) -> list[Line]:
    """Where the main thread waits, which is for good; nothing where any thread spins."""
    frames = sys._current_frames()
    stacks = [stack(frames.get(runner.ident)) for runner in scheduler.runners]
    if any(_is_spin(frame) for lines in stacks for frame, _ in lines):
        return []
    return stack(frames.get(scheduler.main.ident))


def _is_spin(frame: FrameType) -> bool:
    module = str(frame.f_globals.get("__name__", ""))
    return frame.f_code.co_name == "spin" and module.startswith("rclpy")


def find_refused(error: BaseException, now_ns: int) -> Stuck | None:
    """Describe a spin within a spin that this rclpy has refused, where others would be stuck.

    Returns: None for another exception.
    """
    lines = trace(error.__traceback__)
    is_refused = (
        isinstance(error, RuntimeError)
        and str(error) == "Executor is already spinning"
        and lines[-1][0].f_globals.get("__name__") == "rclpy.executors"
    )
    return _stuck(lines, "callback", now_ns) if is_refused else None


def _stuck(lines: list[Line], kind: str, now_ns: int) -> Stuck:
    advice = IN_CALLBACK if kind == "callback" else OUTSIDE
    text = MESSAGE.format(time_s=now_ns / 1e9, stack=_format(lines), advice=advice)
    return Stuck(text, kind, lines)


def _format(lines: list[Line]) -> str:
    """As a traceback, without our own lines."""
    shown = [line for line in lines if not _is_ours(line[0].f_code.co_filename)]
    return "".join(traceback.StackSummary.extract(iter(shown)).format())


def _is_ours(filename: str) -> bool:
    return (
        faults.is_ours(filename)
        or filename.startswith(("<frozen runpy", "<frozen importlib"))
        or filename.endswith("/runpy.py")
    )
