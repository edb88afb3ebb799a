"""The scene at work: a turtlesim node, served and ticked, with a recorder."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from itertools import count

from grader.scenes.scene import Forecast, Hooks, Limits, Reason, Start
from grader.scenes.turtlesim.end_of_run import EndOfRun
from grader.scenes.turtlesim.recorder import Recorder
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from turtlesim_py.ros import pacer
from turtlesim_py.ros.node import TurtlesimNode
from turtlesim_py.ros.turtle_endpoints import pose_bytes
from turtlesim_py.world.arena import TICK_NS, Arena
from turtlesim_py.world.turtle import TICK_S, Pose, Reading

#: How often the node is served although nothing has come [ticks]: goals expire.
SERVE_TICKS = 63
#: What every turtle looks like; the node would choose one of many.
SPRITE = "rolling"


class HookedNode(TurtlesimNode):
    """A turtlesim node that is served only where something has come, and tells when it was."""

    def __init__(self, hooks: Hooks, interfaces: str) -> None:
        self._hooks = hooks
        parameters = [f"turtle_image:={SPRITE}"]
        if interfaces:
            parameters.append(f"interfaces:={interfaces}")
        super().__init__(["--ros-args", *(word for text in parameters for word in ("-p", text))])

    def serve(self, now_ns: int | None = None) -> int:
        """Serve what has arrived, if anything has."""
        if now_ns is None:
            now_ns = int(self.get_clock().now().nanoseconds)
        if not self._hooks.has_unread() and self.arena.ticks % SERVE_TICKS:
            self._set_time(now_ns)
            return now_ns
        return super().serve(now_ns)

    def foresee(self, most: int, is_certain: Callable[[dict[str, Pose]], bool]) -> Forecast:
        """The poses of the next ticks, as far as nothing but driving happens.

        Args:
            is_certain: told the poses of a tick to come; False where that is not to be foreseen.
        """
        twins = self.arena.twins()
        if twins is None or self.follows_ros_clock:
            return Forecast((), [])
        publishers = tuple(self._endpoints[twin.name].pose_publisher for twin in twins)
        begin_ns = self.arena.now_ns
        until_served = -self.arena.ticks % SERVE_TICKS
        end_ns = begin_ns + min(most, until_served) * TICK_NS
        ticks: list[tuple[bytes, ...]] = []
        for now_ns in range(begin_ns, end_ns, TICK_NS):
            poses: dict[str, Pose] = {}
            for twin in twins:
                if (pose := twin.foresee(now_ns)) is None:
                    return Forecast(publishers, ticks)
                poses[twin.name] = pose
            if not is_certain(poses):
                break
            ticks.append(tuple(map(pose_bytes, poses.values())))
        return Forecast(publishers, ticks)

    def pass_tick(self, now_ns: int) -> dict[str, Reading]:
        """As `tick` where there is nothing to serve, but nothing of the turtles is published."""
        self._set_time(now_ns)
        readings = self.arena.tick()
        self._window.publish_if_due()
        return readings


class TurtlesimSimulation:
    """One arena, its node, a recorder, and the rule for the end.

    Attributes:
        node: `/turtlesim`.
    """

    def __init__(
        self, limits: Limits, start: Start | None, hooks: Hooks, interfaces: str = ""
    ) -> None:
        self.node = HookedNode(hooks, interfaces)
        _place(self.node.arena, start)
        self._recorder = Recorder(self.node.arena)
        self._end = EndOfRun(limits)
        self._records = False

    @property
    def is_at_rest(self) -> bool:
        """Whether turtle1 has moved, and does not now."""
        return self._end.is_at_rest

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
        if self.node.follows_ros_clock:
            now_ns = None
        readings = self.node.tick(now_ns)
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
        poses = tuple([pose_bytes(reading.pose) for reading in readings.values()])
        return self._take(readings), poses

    def trace(self) -> TurtleTrace:
        """Everything recorded up to now."""
        return self._recorder.trace()


def _place(arena: Arena, start: Start | None) -> None:
    """Put turtle1 where a run is to begin, without a stroke and before anything is recorded."""
    if start is not None:
        arena.turtles[FIRST_TURTLE].place(start.x, start.y, start.theta)
