"""The scene at work: a turtlesim node, served and ticked, with a recorder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from itertools import count
from typing import Any

from grader.message import Message
from grader.recording.subject import Start
from grader.scenes.scene import GRACE_TICKS, Forecast, Hooks, Limits, Reason, Simulation
from grader.scenes.turtlesim.allowance import MOST_LOGS
from grader.scenes.turtlesim.driving import Recorder
from grader.scenes.turtlesim.graded_node import GradedNode
from grader.scenes.turtlesim.setting import script
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from turtlesim_py.live.feed import Feed, News
from turtlesim_py.ros.turtle_endpoints import pose_bytes
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.turtle import TICK_S, Pose, Reading


class TurtlesimSimulation(Simulation):
    """One arena, its node, a recorder, and the rule for the end.

    Attributes:
        node: `/turtlesim`.
    """

    node: GradedNode

    def __init__(
        self, limits: Limits, start: Start | None, hooks: Hooks, interfaces: str, setting: str
    ) -> None:
        super().__init__()
        self.node = GradedNode(hooks, interfaces)
        _place(self.node.arena, start)
        self._recorder = Recorder(self.node.arena, MOST_LOGS)
        self._end = EndOfRun(limits)
        there, self._script = script(setting)
        self.node.play(there, None)
        self._feed = None if hooks.tell is None else _feed(self.node.arena, hooks.tell)

    @property
    def is_at_rest(self) -> bool:
        """Whether turtle1 has moved, and does not now."""
        return self._end.is_at_rest

    @property
    def flags(self) -> tuple[Message, ...]:
        """What the submission asked for and did not get."""
        return self.node.allowance.flags

    @property
    def ticks(self) -> int:
        """How many ticks were recorded."""
        return self._recorder.ticks

    def submission_gone(self) -> None:
        """The submission's process has ended."""
        self._end.submission_gone()

    def tick(self, now_ns: int | None = None) -> Reason:
        """Serve what has arrived, let a tick pass; why the run is over, or ''."""
        if self.records and (events := self._script.get(self._recorder.ticks + 1)):
            self.node.play(events, now_ns)
        readings = self.node.tick(now_ns)
        if self._feed is not None:
            self._feed.after_tick(readings)
        return self._take(readings) if self.records else ""

    def _take(self, readings: dict[str, Reading]) -> Reason:
        self._recorder.take(readings)
        poses = {name: reading.pose for name, reading in readings.items()}
        return self._end.after(self._recorder.ticks, self._about(poses))

    def _about(self, poses: Mapping[str, Pose]) -> Mapping[str, Pose]:
        """Those of the turtles that the run is about: turtle1; where a script has others, all."""
        if self._script:
            return poses
        return {FIRST_TURTLE: poses[FIRST_TURTLE]} if FIRST_TURTLE in poses else {}

    def foresee(self, most: int) -> Forecast:
        """The next ticks, so many at most: as far as they are certain if nothing arrives."""
        end = copy(self._end)
        ticks = count(self._recorder.ticks + 1)

        def goes_on(poses: dict[str, Pose]) -> bool:
            tick = next(ticks)
            return tick not in self._script and not end.after(tick, self._about(poses))

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

    def deliver(news: News) -> None:
        tell(news.content)  # nobody asks for a whole: who looks on knows all from the beginning

    feed = Feed(arena, deliver, together=1)
    feed.is_watched = True
    feed.after_tick({})
    return feed


def _place(arena: Arena, start: Start | None) -> None:
    """Put turtle1 where a run is to begin, without a stroke and before anything is recorded."""
    if start is not None:
        arena.turtles[FIRST_TURTLE].place(start.x, start.y, start.theta)


class EndOfRun:
    """Decides when there is nothing more to see.

    The turtle has driven and rested; or nothing has moved for too long; or the submission is gone
    and nothing moved; or time is up. Who has only turned on the spot has not begun to drive, and
    may pause for as long as anybody may before the first motion.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._last_poses: Mapping[str, Pose] = {}
        self._moved = False
        self._driven = False
        self._still_ticks = 0
        self._gone_ticks: int | None = None

    @property
    def is_at_rest(self) -> bool:
        """Whether the turtle has moved, and does not now."""
        return self._moved and self._still_ticks > 0

    def submission_gone(self) -> None:
        """The submission's process has ended."""
        self._gone_ticks = 0

    def after(self, tick: int, poses: Mapping[str, Pose]) -> Reason:
        """Why to stop after this tick, or ''; `poses` are of the turtles that the run is about."""
        self._watch(poses)
        if self._gone_ticks is not None:
            self._gone_ticks += 1
        if tick * TICK_S >= self._limits.total_s:
            return "time_limit"
        if self._moved:
            return "rest" if self._still_ticks * TICK_S >= self._patience_s() else ""
        if self._gone_ticks is not None and self._gone_ticks >= GRACE_TICKS:
            return "gone"
        return "no_motion" if tick * TICK_S >= self._limits.first_motion_s else ""

    def _patience_s(self) -> float:
        """How long a rest ends the run [s]."""
        has_begun = self._driven or self._gone_ticks is not None
        rest_s = self._limits.rest_s
        return rest_s if has_begun else max(rest_s, self._limits.first_motion_s)

    def _watch(self, poses: Mapping[str, Pose]) -> None:
        known = self._last_poses
        both = [(known[name], pose) for name, pose in poses.items() if name in known]
        still = all(before[:3] == pose[:3] for before, pose in both)
        self._moved = self._moved or not still
        self._driven = self._driven or any(before[:2] != pose[:2] for before, pose in both)
        self._still_ticks = self._still_ticks + 1 if still else 0
        self._last_poses = poses
