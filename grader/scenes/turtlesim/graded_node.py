"""The turtlesim node of a graded run: it foresees ticks, and refuses requests beyond limits.

The limits are far above what it takes to drive turtles. They keep every run short and its recording
small; a turtlesim that grades nobody has none.
"""

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
from grader.scenes.turtlesim.trace import SPRITE
from grader.text.message import NOTHING, Message, msg
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


#: Turtles at a time: each publishes in every tick, and has a trajectory in the recording.
MOST_TURTLES = 32
#: Turtles in a run, with those of `reset`: each needs fifteen endpoints of DDS.
MOST_HATCHED = 200
#: Inputs in a run: the whole recording is judged, and written to disk.
MOST_EVENTS = 100_000
#: Lines of the simulator's log in a run.
MOST_LOGS = 20_000
#: Rotation goals at a time: running, or ended in the last ten seconds. All of them are in each
#: message of an action's status.
MOST_GOALS = 100
#: Entries of one request to a service for parameters.
MOST_ENTRIES = 1_000
#: Pictures that `save_canvas` writes in a run.
MOST_PICTURES = 100
#: Of a name [characters]; ROS allows less, so no turtle has a longer one.
LONGEST_NAME = 300
#: Parameters that decide how a run is judged, or where files are written.
FIXED = {
    "use_sim_time": msg("the parameter use_sim_time cannot be set: the run has a clock of its own"),
    "canvas_folder": msg(
        "the parameter canvas_folder cannot be set: the run has a folder of its own"
    ),
}
#: More different remarks than this are not kept.
MOST_FLAGS = 20
_NOT_ALL = msg(
    "what the node sent after its first {number} messages was not taken", number=MOST_EVENTS
)
_FIRST_LINES = msg("of the simulator's log the first {number} lines were kept", number=MOST_LOGS)
_NO_MORE_PICTURES = msg("save_canvas wrote {number} pictures and no more", number=MOST_PICTURES)
_MANY_AT_A_TIME = msg(
    "more than {number} turtles at a time: the others were refused", number=MOST_TURTLES
)
_MANY_IN_A_RUN = msg(
    "more than {number} turtles in a run: the others were refused", number=MOST_HATCHED
)


class Allowance:
    """Counts what a run has used.

    Attributes:
        hatched: the number of turtles that there have been.
        events, logs, pictures: their numbers.
    """

    def __init__(self) -> None:
        self.hatched = self.events = self.logs = self.pictures = 0
        self._flags: dict[Message, None] = {}

    @property
    def flags(self) -> tuple[Message, ...]:
        return tuple(self._flags)

    def refuse(self, remark: Message) -> None:
        if len(self._flags) < MOST_FLAGS:
            self._flags[remark] = None

    def _allow(self, is_within: bool, remark: Message) -> bool:
        if not is_within:
            self.refuse(remark)
        return is_within

    @property
    def is_used_up(self) -> bool:
        return not self._allow(self.events < MOST_EVENTS, _NOT_ALL)

    def may_log(self) -> bool:
        self.logs += 1
        return self._allow(self.logs <= MOST_LOGS, _FIRST_LINES)

    def may_save(self) -> bool:
        self.pictures += 1
        return self._allow(self.pictures <= MOST_PICTURES, _NO_MORE_PICTURES)

    def why_not_hatch(self, turtles: int) -> Message:
        """Return why there may be no turtle beside so many others; NOTHING where there may."""
        if turtles >= MOST_TURTLES:
            remark = _MANY_AT_A_TIME
        elif self.hatched >= MOST_HATCHED:
            remark = _MANY_IN_A_RUN
        else:
            return NOTHING
        self.refuse(remark)
        return remark


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
            self.log("ERROR", f"Cannot spawn a turtle named [{request.name}]: {why!s}")
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
            self.log("ERROR", f"Cannot reset: {why!s}")
            return response
        self.allowance.hatched += 1
        return super()._on_reset(request, response)

    def accepts_goal(self) -> bool:
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
