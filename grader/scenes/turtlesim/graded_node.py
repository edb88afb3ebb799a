"""The turtlesim node of a graded run: it foresees ticks, and refuses requests beyond limits."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    GetParameterTypes,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from grader.scenes.scene import Forecast, Hooks
from grader.scenes.turtlesim.allowance import (
    FIXED,
    LONGEST_NAME,
    MOST_ENTRIES,
    MOST_GOALS,
    MOST_PICTURES,
    Allowance,
)
from grader.scenes.turtlesim.trace import SPRITE
from grader.text.message import msg
from turtlesim_py.ros.node import TurtlesimNode
from turtlesim_py.ros.turtle_endpoints import pose_bytes
from turtlesim_py.scenario import apply
from turtlesim_py.world.arena import TICK_NS
from turtlesim_py.world.events import Event, LogLine, Notice
from turtlesim_py.world.turtle import Pose, Reading

#: How often the node is served although nothing has arrived [ticks]: goals expire.
SERVE_TICKS = 63
#: Service for parameters -> the field with the entries of its request.
ENTRIES = {
    SetParameters: "parameters",
    SetParametersAtomically: "parameters",
    GetParameters: "names",
    GetParameterTypes: "names",
    DescribeParameters: "names",
    ListParameters: "prefixes",
}


class GradedNode(TurtlesimNode):
    """A turtlesim node that is served only when something has arrived, and within limits.

    Attributes:
        allowance: what has been used and refused.
    """

    MAY_BE_SEEN = False

    def __init__(self, hooks: Hooks, interfaces: str) -> None:
        self._hooks = hooks
        self.allowance = Allowance()
        parameters = [f"turtle_image:={SPRITE}"]  # the node would choose one of many
        if interfaces:
            parameters.append(f"interfaces:={interfaces}")
        super().__init__(["--ros-args", *(word for text in parameters for word in ("-p", text))])
        self._confine()

    def serve(self, now_ns: int | None = None) -> int:
        """Serve what has arrived, if anything has."""
        if now_ns is None:
            now_ns = int(self.get_clock().now().nanoseconds)
        is_quiet = not self._hooks.has_unread() and self.arena.ticks % SERVE_TICKS
        if is_quiet or self.allowance.is_used_up:
            self._set_time(now_ns)
            return now_ns
        return super().serve(now_ns)

    def play(self, script: Iterable[Event], now_ns: int | None) -> None:
        """Apply the events of a script for the next tick."""
        self._set_time(self._now_ns() if now_ns is None else now_ns)
        for event in script:
            apply(self.arena, event)
        self._sync_endpoints()

    def foresee(self, most: int, is_certain: Callable[[dict[str, Pose]], bool]) -> Forecast:
        """Return the poses of the next ticks, as far as nothing but driving happens.

        Args:
            is_certain: called with the poses of a coming tick; False ends the forecast before it.
        """
        twins = self.arena.twins()
        if twins is None:
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
        """Let a tick pass without serving and without publishing of the turtles; see `tick`."""
        self._set_time(now_ns)
        readings = self.arena.tick()
        self._window.publish_if_due()
        return readings

    # Limits -----------------------------------------------------------------------------------

    def _confine(self) -> None:
        """Guard the services by the limits."""
        for service in self.services:
            if service.srv_type in ENTRIES:
                field = ENTRIES[service.srv_type]
                service.callback = partial(self._on_entries, service.callback, field)
            elif service.srv_type is Trigger:
                service.callback = partial(self._on_picture, service.callback)

    def _on_entries(self, serve: Callable[..., Any], field: str, request: Any, answer: Any) -> Any:
        if len(getattr(request, field)) > MOST_ENTRIES:
            self.allowance.refuse(
                msg("requests for more than {number} parameters were refused", number=MOST_ENTRIES)
            )
            return answer
        return serve(request, answer)

    def _on_picture(self, serve: Callable[..., Any], request: Any, answer: Any) -> Any:
        if self.allowance.may_save():
            return serve(request, answer)
        answer.success = False
        answer.message = f"a graded run has {MOST_PICTURES} pictures at most"
        return answer

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Set parameters, except those that a run depends on."""
        for parameter in parameter_list:
            name, value = parameter.name, parameter.value
            if name not in FIXED or value == (now := self.get_parameter(name).value):
                continue
            if type(value) is type(now):  # else rclpy has a better reason
                self.allowance.refuse(FIXED[name])
                return SetParametersResult(successful=False, reason=str(FIXED[name]))
        return super().set_parameters_atomically(parameter_list)

    def _on_spawn(self, request: Any, response: Any) -> Any:
        # as wrong after the cut as before
        request.name = request.name[:LONGEST_NAME]
        if why := self.allowance.why_not_hatch(len(self.arena.turtles)):
            self.log("ERROR", f"Cannot spawn a turtle named [{request.name}]: {why}")
            response.name = ""
            return response
        response = super()._on_spawn(request, response)
        self.allowance.hatched += bool(response.name)
        return response

    def _on_kill(self, request: Any, response: Any) -> Any:
        request.name = request.name[:LONGEST_NAME]
        return super()._on_kill(request, response)

    def _on_reset(self, request: Any, response: Any) -> Any:
        if why := self.allowance.why_not_hatch(0):
            self.log("ERROR", f"Cannot reset: {why}")
            return response
        self.allowance.hatched += 1
        return super()._on_reset(request, response)

    def accepts_goal(self) -> bool:
        """Whether there are not too many goals."""
        if sum(each.action.known for each in self._endpoints.values()) < MOST_GOALS:
            return True
        self.allowance.refuse(
            msg("more than {number} rotation goals in ten seconds were refused", number=MOST_GOALS)
        )
        return False

    def on_failure(self, what: str, error: Exception) -> None:
        """Log a failure, and put it into the result: nothing should fail."""
        name = type(error).__name__
        self.allowance.refuse(
            msg("the simulator could not serve {what}: {error}", what=what, error=name)
        )
        super().on_failure(what, error)

    def _on_notice(self, notice: Notice) -> None:
        if isinstance(notice, Event):
            self.allowance.events += 1
        if not isinstance(notice, LogLine) or self.allowance.may_log():
            super()._on_notice(notice)
