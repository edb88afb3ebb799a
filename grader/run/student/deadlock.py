"""A node that waits for something that can no longer happen, and where it does."""

from __future__ import annotations

import sys
import traceback
from types import CodeType, FrameType

from grader.run.lockstep import faults
from grader.run.student.scheduler import Scheduler

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


def find(scheduler: Scheduler, runs_callback: CodeType, waits: frozenset[CodeType]) -> str:
    """Describe the first thread that is stuck in a callback or in a waiting call of rclpy's.

    Args:
        scheduler: all of whose threads are blocked for good.
        runs_callback: the code of rclpy that callbacks are called from.
        waits: code of rclpy that waits for another thread to spin.

    Returns: '' where threads only wait, as a program may that has done its work.
    """
    frames = sys._current_frames()
    for runner in scheduler.runners:
        stack = _stack(frames.get(runner.ident))
        codes = [frame.f_code for frame in stack]
        if runs_callback in codes or not waits.isdisjoint(codes):
            advice = IN_CALLBACK if runs_callback in codes else OUTSIDE
            return MESSAGE.format(
                time_s=scheduler.now_ns / 1e9, stack=_format(_lines(stack)), advice=advice
            )
    return ""


def find_refused(error: BaseException, now_ns: int) -> str:
    """Describe a spin within a spin that this rclpy has refused, where others would be stuck.

    Returns: '' for another exception.
    """
    trace = list(traceback.walk_tb(error.__traceback__))
    is_refused = (
        isinstance(error, RuntimeError)
        and str(error) == "Executor is already spinning"
        and trace[-1][0].f_globals.get("__name__") == "rclpy.executors"
    )
    if not is_refused:
        return ""
    return MESSAGE.format(time_s=now_ns / 1e9, stack=_format(trace), advice=IN_CALLBACK)


def _stack(frame: FrameType | None) -> list[FrameType]:
    """Outermost first."""
    stack = []
    while frame is not None:
        stack.append(frame)
        frame = frame.f_back
    return stack[::-1]


def _lines(stack: list[FrameType]) -> list[tuple[FrameType, int]]:
    return [(frame, frame.f_lineno) for frame in stack]


def _format(lines: list[tuple[FrameType, int]]) -> str:
    """As a traceback, without our own lines."""
    shown = [line for line in lines if not _is_ours(line[0].f_code.co_filename)]
    return "".join(traceback.StackSummary.extract(iter(shown)).format())


def _is_ours(filename: str) -> bool:
    return (
        faults.is_ours(filename)
        or filename.startswith(("<frozen runpy", "<frozen importlib"))
        or filename.endswith("/runpy.py")
    )
