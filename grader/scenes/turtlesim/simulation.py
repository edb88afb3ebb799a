"""The simulation: a turtlesim node that is served and ticked, and a recorder."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from itertools import count
from typing import Any

from grader.recording.subject import Start
from grader.scenes.scene import GRACE_TICKS, Forecast, Hooks, Limits, Reason, Simulation
from grader.scenes.turtlesim.graded_node import MOST_LOGS, GradedNode
from grader.scenes.turtlesim.recorder import Recorder, place
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from grader.text.message import Message
from turtlesim_py.live.feed import Feed, News
from turtlesim_py.ros.turtle_endpoints import pose_bytes
from turtlesim_py.scenario import events_by_tick, parse
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.events import Event, Spawn
from turtlesim_py.world.turtle import TICK_S, Pose, Reading


class TurtlesimSimulation(Simulation):
    """An arena with its node, a recorder, and the rule that ends the run.

    Attributes:
        node: `/turtlesim`.
    """

    node: GradedNode

    def __init__(
        self, limits: Limits, start: Start | None, hooks: Hooks, interfaces: str, setting: str
    ) -> None:
        super().__init__()
        self.node = GradedNode(hooks, interfaces)
        place(self.node.arena, start)
        self._recorder = Recorder(self.node.arena, MOST_LOGS)
        self._end = EndOfRun(limits)
        before, self._script = script(setting)
        self.node.play(before, None)
        send = hooks.send_news
        self._feed = None if send is None else _feed(self.node.arena, send)

    @property
    def is_at_rest(self) -> bool:
        return self._end.is_at_rest

    @property
    def flags(self) -> tuple[Message, ...]:
        return self.node.allowance.flags

    @property
    def ticks(self) -> int:
        return self._recorder.ticks

    def tick(self, now_ns: int | None = None) -> Reason:
        if self.records and (events := self._script.get(self._recorder.ticks + 1)):
            self.node.play(events, now_ns)
        readings = self.node.tick(now_ns)
        if self._feed is not None:
            self._feed.after_tick(readings)
        return self._record(readings) if self.records else ""

    def _record(self, readings: dict[str, Reading]) -> Reason:
        self._recorder.record(readings)
        poses = {name: reading.pose for name, reading in readings.items()}
        return self._end.after(self._recorder.ticks, self._about(poses), self.gone_tick)

    def _about(self, poses: Mapping[str, Pose]) -> Mapping[str, Pose]:
        """Return the poses that can end the run: turtle1's, or all where there is a script."""
        if self._script:
            return poses
        return {FIRST_TURTLE: poses[FIRST_TURTLE]} if FIRST_TURTLE in poses else {}

    def foresee(self, most: int) -> Forecast:
        end = copy(self._end)
        ticks = count(self._recorder.ticks + 1)

        def goes_on(poses: dict[str, Pose]) -> bool:
            tick = next(ticks)
            over = end.after(tick, self._about(poses), self.gone_tick)
            return tick not in self._script and not over

        return self.node.foresee(most, goes_on)

    def pass_tick(self, now_ns: int) -> tuple[Reason, tuple[bytes, ...]]:
        readings = self.node.pass_tick(now_ns)
        if self._feed is not None:
            self._feed.after_tick(readings)
        poses = tuple([pose_bytes(reading.pose) for reading in readings.values()])
        return self._record(readings), poses

    def trace(self) -> TurtleTrace:
        return self._recorder.trace()


def _feed(arena: Arena, send: Callable[[Mapping[str, Any]], None]) -> Feed:
    """Return a feed that sends the news of every tick; the state at the begin is sent here."""

    def deliver(news: News) -> None:
        send(news.content)  # never all of an arena: the audience has the news from the beginning

    feed = Feed(arena, deliver, together=1)
    feed.is_watched = True
    feed.after_tick({})
    return feed


def script(setting: str) -> tuple[Sequence[Event], Mapping[int, Sequence[Event]]]:
    """Return a scenario's events before a run begins, and those by tick; 1 is recorded first.

    Turtles of tick 1 are spawned before the run: a submission that waits for a later one would look
    as if it waited in vain.
    """
    if not setting:
        return (), {}
    by_tick = {
        tick: [event for _, event in each] for tick, each in events_by_tick(parse(setting)).items()
    }
    spawned = [event for event in by_tick.get(1, ()) if isinstance(event, Spawn)]
    if spawned:
        by_tick[1] = [event for event in by_tick[1] if event not in spawned]
    return spawned, by_tick


class EndOfRun:
    """Decides when the run is over.

    The turtle has driven and rested; or nothing has moved for too long; or the submission is gone
    and nothing moved; or time is up. A turtle that has only turned on the spot may rest for as long
    as before the first motion.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._last_poses: Mapping[str, Pose] = {}
        self._moved = False
        self._driven = False
        self._still_ticks = 0

    @property
    def is_at_rest(self) -> bool:
        return self._moved and self._still_ticks > 0

    def after(self, tick: int, poses: Mapping[str, Pose], gone_tick: int | None = None) -> Reason:
        """Return why to stop after this tick, or ''.

        Args:
            poses: those that can end the run.
            gone_tick: the last tick before the end of the submission's process.
        """
        limits = self._limits
        self._watch(poses)
        if tick * TICK_S >= limits.total_s:
            return "time_limit"
        if self._moved:
            has_begun = self._driven or gone_tick is not None
            rest_s = limits.rest_s if has_begun else max(limits.rest_s, limits.first_motion_s)
            return "rest" if self._still_ticks * TICK_S >= rest_s else ""
        if gone_tick is not None and tick - gone_tick >= GRACE_TICKS:
            return "gone"
        return "no_motion" if tick * TICK_S >= limits.first_motion_s else ""

    def _watch(self, poses: Mapping[str, Pose]) -> None:
        self._still_ticks += 1
        for name, pose in poses.items():
            before = self._last_poses.get(name, pose)
            if before[:3] != pose[:3]:
                self._moved, self._still_ticks = True, 0
                self._driven = self._driven or before[:2] != pose[:2]
        self._last_poses = poses
