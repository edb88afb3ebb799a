"""The scene at work: a turtlesim node, served and ticked, with a recorder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from itertools import count
from typing import Any

from grader.scenes.scene import Forecast, Hooks, Limits, Reason, Start
from grader.scenes.turtlesim.allowance import MOST_LOGS
from grader.scenes.turtlesim.end_of_run import EndOfRun
from grader.scenes.turtlesim.graded_node import GradedNode
from grader.scenes.turtlesim.recorder import Recorder
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from turtlesim_py.live.feed import Change, Feed, Whole
from turtlesim_py.ros import pacer
from turtlesim_py.ros.turtle_endpoints import pose_bytes
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.turtle import TICK_S, Pose, Reading


class TurtlesimSimulation:
    """One arena, its node, a recorder, and the rule for the end.

    Attributes:
        node: `/turtlesim`.
    """

    def __init__(
        self, limits: Limits, start: Start | None, hooks: Hooks, interfaces: str = ""
    ) -> None:
        self.node = GradedNode(hooks, interfaces)
        _place(self.node.arena, start)
        self._recorder = Recorder(self.node.arena, MOST_LOGS)
        self._end = EndOfRun(limits)
        self._records = False
        self._feed = None if hooks.tell is None else _feed(self.node.arena, hooks.tell)

    @property
    def is_at_rest(self) -> bool:
        """Whether turtle1 has moved, and does not now."""
        return self._end.is_at_rest

    @property
    def flags(self) -> tuple[str, ...]:
        """What the submission asked for and did not get."""
        return self.node.allowance.flags

    @property
    def recorded_s(self) -> float:
        """How long it has recorded [simulated s]."""
        return self._recorder.ticks * TICK_S

    def record(self) -> None:
        """Record from the next tick on; inputs are recorded from the beginning."""
        self._records = True

    def submission_gone(self) -> None:
        """The submission's process has ended."""
        self._end.submission_gone()

    def follow_wall_clock(self, step: Callable[[], bool]) -> None:
        """Call `step` every 16 ms, until it returns False."""
        pacer.follow_wall_clock(step)

    def tick(self, now_ns: int | None = None) -> Reason:
        """Serve what has arrived, let a tick pass; why the run is over, or ''."""
        readings = self.node.tick(now_ns)
        if self._feed is not None:
            self._feed.after_tick(readings)
        return self._take(readings) if self._records else ""

    def _take(self, readings: dict[str, Reading]) -> Reason:
        self._recorder.take(readings)
        first = readings.get(FIRST_TURTLE)
        return self._end.after(self._recorder.ticks, first.pose if first else None)

    def foresee(self, most: int) -> Forecast:
        """The next ticks, so many at most: as far as they are certain if nothing arrives."""
        end = copy(self._end)
        ticks = count(self._recorder.ticks + 1)

        def goes_on(poses: dict[str, Pose]) -> bool:
            return not end.after(next(ticks), poses.get(FIRST_TURTLE))

        return self.node.foresee(most, goes_on)

    def pass_tick(self, now_ns: int) -> tuple[Reason, tuple[bytes, ...]]:
        """As `tick`, in a tick that was foreseen: publishes nothing, returns what it would have."""
        readings = self.node.pass_tick(now_ns)
        if self._feed is not None:
            self._feed.after_tick(readings)
        poses = tuple([pose_bytes(reading.pose) for reading in readings.values()])
        return self._take(readings), poses

    def trace(self) -> TurtleTrace:
        """Everything recorded up to now."""
        return self._recorder.trace()


def _feed(arena: Arena, tell: Callable[[Mapping[str, Any]], None]) -> Feed:
    """What tells of every tick, and has told already where the run begins."""

    def deliver(news: Change | Whole) -> None:
        tell(news.content)  # nobody asks for a whole: who looks on knows all from the beginning

    feed = Feed(arena, deliver, together=1)
    feed.is_watched = True
    feed.after_tick({})
    return feed


def _place(arena: Arena, start: Start | None) -> None:
    """Put turtle1 where a run is to begin, without a stroke and before anything is recorded."""
    if start is not None:
        arena.turtles[FIRST_TURTLE].place(start.x, start.y, start.theta)
