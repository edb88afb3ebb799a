"""The scene at work: its node, served in each tick, a recorder, and the rule for the end."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy

from grader.scenes.robot.end_of_run import EndOfRun
from grader.scenes.robot.recorder import Recorder
from grader.scenes.robot.state_node import StateNode
from grader.scenes.robot.trace import TICK_S, RobotTrace
from grader.scenes.scene import Forecast, Hooks, Limits, Reason
from turtlesim_py.ros import pacer


class RobotSimulation:
    """See `grader.scenes.scene.Simulation`.

    Attributes:
        node: `/robot_state_publisher`.
    """

    is_at_rest = False  # a robot is never done

    def __init__(self, limits: Limits, hooks: Hooks, description: str) -> None:
        self._hooks = hooks
        self._recorder = Recorder()
        self.node = StateNode(description, self._recorder)
        self._end = EndOfRun(limits)
        self._records = False

    @property
    def flags(self) -> tuple[str, ...]:
        """What of the submission's messages was not taken."""
        return self._recorder.flags

    @property
    def recorded_s(self) -> float:
        """How long it has recorded [simulated s]."""
        return self._recorder.ticks * TICK_S

    def record(self) -> None:
        """Count ticks from the next one on; messages are recorded from the beginning."""
        self._records = True

    def submission_gone(self) -> None:
        """The submission's process has ended."""
        self._end.submission_gone()

    def follow_wall_clock(self, step: Callable[[], bool]) -> None:
        """Call `step` every 16 ms, until it returns False."""
        pacer.follow_wall_clock(step)

    def tick(self, now_ns: int | None = None) -> Reason:
        """Serve what has arrived, let a tick pass; why the run is over, or ''."""
        if now_ns is None:
            now_ns = int(self.node.get_clock().now().nanoseconds)
        if self._hooks.has_unread():
            self.node.serve(now_ns)
        return self._pass()

    def _pass(self) -> Reason:
        if not self._records:
            return ""
        self._recorder.ticks += 1
        return self._end.after(self._recorder.ticks, self._recorder.heard)

    def foresee(self, most: int) -> Forecast:
        """The next ticks: nothing is published but in answer to a joint state."""
        end = copy(self._end)
        first = self._recorder.ticks + 1
        count = 0
        while count < most and not end.after(first + count, self._recorder.heard):
            count += 1
        return Forecast((), [()] * count)

    def pass_tick(self, now_ns: int) -> tuple[Reason, tuple[bytes, ...]]:
        """As `tick`, where nothing has arrived."""
        return self._pass(), ()

    def trace(self) -> RobotTrace:
        """Everything recorded up to now."""
        return self._recorder.trace()
