"""The node of an arena: topics, services, action, parameters, logs."""

from __future__ import annotations

import gc
import sys
import time
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

from rcl_interfaces.msg import ParameterEvent
from rclpy.exceptions import NameValidationException
from rclpy.expand_topic_name import expand_topic_name
from rclpy.logging import LoggingSeverity
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.time_source import CLOCK_TOPIC, USE_SIM_TIME_NAME
from rclpy.validate_full_topic_name import validate_full_topic_name
from std_srvs.srv import Empty

from turtlesim_py.ros import program, window
from turtlesim_py.ros.executor import TickExecutor
from turtlesim_py.ros.rclcpp_node import RclcppNode, UnusableParameter
from turtlesim_py.ros.turtle_endpoints import TurtleEndpoints
from turtlesim_py.world.arena import BY_NAME, PARAMETERS, Arena
from turtlesim_py.world.events import GoalFeedback, GoalResult, LogLine, Notice
from turtlesim_py.world.floats import printf_f
from turtlesim_py.world.turtle import SPRITES, Reading

if TYPE_CHECKING:
    from turtlesim_py.live.feed import Feed
    from turtlesim_py.live.server import LiveServer

#: Printed by --help.
ABOUT = """\
The simulator: turtles in a window that is not shown. To see it:
    turtlesim                               (the simulator with a page for a browser)
    ros2 run rqt_image_view rqt_image_view /turtlesim/image
    ros2 service call /turtlesim/save_canvas std_srvs/srv/Trigger    (writes a PNG)

parameters:
    background_r, background_g, background_b   colour of the background, 0 to 255
    holonomic        turtles also go sideways (false)
    turtle_image     picture of every turtle (a random one)
    image_rate       pictures a second on ~/image while somebody looks (10)
    canvas_folder    where ~/save_canvas writes (the current folder)
    view_port        port of a page that shows the turtles; 0: any free one; -1: no page (-1)
    view_host        address at which the page is served (127.0.0.1)
    view_token       what opens the page from elsewhere (one is made)
    view_read_only   whether the page is for looking only (false)
    interfaces       package of the messages: turtlesim or turtlesim_msgs
    use_sim_time     follow /clock (false)"""
#: The longest name that rotate_absolute's hidden services add to a turtle's.
LONGEST_SUFFIX = "/rotate_absolute/_action/cancel_goal"
#: So much of an exception's text is logged [characters]: it may quote a whole request.
LONGEST_REASON = 500
#: How the original listens to changes of parameters.
PARAMETER_EVENTS_QOS = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)


class TurtlesimNode(RclcppNode):
    """The node `/turtlesim`: owns an arena and serves it; its user calls `tick`.

    Args:
        arguments: ROS arguments (`--ros-args ...`) of this node alone; the global ones count too.
        opens_window: whether `open_window` is called here.

    Attributes:
        arena: the turtles and what they have drawn.
        interfaces: the classes of the topics, services and actions.
        tick_executor: serves the node, once in a tick.
        live: serves the page, where one is wanted: the parameter `view_port`.
        follows_ros_clock: whether the time comes from /clock: the parameter `use_sim_time`.

    Raises:
        UnusableParameter: a parameter override is out of range or of the wrong type, or names a
            package that is not there.
        InvalidParameterTypeException: the same, for a parameter of every ROS node.
    """

    #: Whether it may serve a page; a graded one has the parameters that it always had.
    MAY_BE_SEEN: ClassVar = True

    def __init__(self, arguments: list[str] | None = None, opens_window: bool = True) -> None:
        # first, since a node that comes no further is destroyed as well
        self._endpoints: dict[str, TurtleEndpoints] = {}
        self.live: LiveServer | None = None
        self._feed: Feed | None = None
        super().__init__("turtlesim", cli_args=arguments)
        for parameter in PARAMETERS:
            self.declare(parameter.name, parameter.default, parameter.description, parameter.limits)
        sprite = self._declare_sprite()
        self.interfaces = self.declare_interfaces()
        window.declare_parameters(self)
        if self.MAY_BE_SEEN:
            window.declare_page_parameters(self)
        self.log("INFO", f"Starting turtlesim with node name {self.get_fully_qualified_name()}")
        self.arena = Arena((self._on_notice,), sprite=sprite)
        self._window = window.Window(self, self.arena)
        if opens_window:
            self.open_window()
        self._logs_positions = self.get_logger().is_enabled_for(LoggingSeverity.DEBUG)
        self._last_ns = 0
        self._set_back_ns = 0
        self.follows_ros_clock: bool = self.get_clock().ros_time_is_active
        self._set_time(self._now_ns())
        self._sync_endpoints()
        for parameter in PARAMETERS:
            self.arena.set_parameter(parameter.name, self.get_parameter(parameter.name).value)
        self.add_post_set_parameters_callback(self._on_parameters)
        # The original repaints on these; here it only completes the graph.
        self.create_subscription(
            ParameterEvent, "/parameter_events", lambda _: None, PARAMETER_EVENTS_QOS, raw=True
        )
        self.create_service(Empty, "clear", self._on_clear)
        self.create_service(Empty, "reset", self._on_reset)
        self.create_service(self.interfaces.srv.Spawn, "spawn", self._on_spawn)
        self.create_service(self.interfaces.srv.Kill, "kill", self._on_kill)
        self.tick_executor = TickExecutor(self, self.on_failure)
        if self.MAY_BE_SEEN and (
            served := window.serve_page(self, self.arena, self.interfaces.package)
        ):
            self.live, self._feed = served

    def open_window(self) -> None:
        """Offer the window's topics and service, if that has not been done."""
        self._window.open()

    def destroy_node(self) -> None:
        if self.live is not None:
            self.live.stop()
        self._drop_endpoints(set(self._endpoints))  # rclpy forgets actions
        super().destroy_node()

    # Time -------------------------------------------------------------------------------------

    def tick(self, now_ns: int | None = None) -> dict[str, Reading]:
        """Serve what has arrived, update the turtles, publish; return what was published.

        Args:
            now_ns: the time [ns]; without it, the node's clock is asked. While that does not know
                the time (`use_sim_time` without /clock), the turtles are not updated.
        """
        if not self.serve(now_ns):
            return {}
        readings = self.arena.tick()
        for name, reading in readings.items():
            self._endpoints[name].publish(reading)
        if self._logs_positions:
            self._log_positions()
        self._window.publish_if_due()
        if self._feed is not None:
            self._feed.after_tick(readings)
        return readings

    def serve(self, now_ns: int | None = None) -> int:
        """Serve what has arrived without an update; return the time [ns], 0 where not known."""
        if now_ns is None:
            now_ns = self._now_ns()
        self._set_time(now_ns)
        self.tick_executor.spin_some()
        return now_ns

    def hear_clock(self, patience_ns: int) -> int:
        """Wait for a message on /clock, at most so long; return the node's time [ns]."""
        self.tick_executor.wait_for(CLOCK_TOPIC, patience_ns)
        return self._now_ns()

    def _now_ns(self) -> int:
        now_ns: int = self.get_clock().now().nanoseconds
        return now_ns

    def _set_time(self, now_ns: int) -> None:
        """Set the arena's time.

        It never goes back: commands would else keep turtles moving until a clock that was
        set back is again where it was.
        """
        self._set_back_ns += max(0, self._last_ns - now_ns)
        self._last_ns = now_ns
        self.arena.now_ns = now_ns + self._set_back_ns

    def on_failure(self, what: str, error: Exception) -> None:
        """Log that a message or request could not be served; the node goes on."""
        reason = f"{type(error).__name__}: {error}"
        self.log("ERROR", f"Cannot serve [{what}]: {reason[:LONGEST_REASON]}")

    # Parameters -------------------------------------------------------------------------------

    def _declare_sprite(self) -> str:
        expected = f"one of {', '.join(SPRITES)}"
        sprite = self.declare(
            "turtle_image",
            "",
            f"Picture of every turtle, {expected}; empty: a random one",
            read_only=True,
        )
        if sprite and sprite not in SPRITES:
            raise UnusableParameter("turtle_image", sprite, expected)
        return sprite

    def _on_parameters(self, parameters: list[Parameter]) -> None:
        for parameter in parameters:
            if parameter.name in BY_NAME:
                self.arena.set_parameter(parameter.name, parameter.value)
            elif parameter.name == USE_SIM_TIME_NAME:
                self.follows_ros_clock = parameter.value

    # Services ---------------------------------------------------------------------------------

    def _on_clear(self, _: Any, response: Any) -> Any:
        self.arena.clear()
        return response

    def _on_reset(self, _: Any, response: Any) -> Any:
        self.arena.reset()
        # The new turtle1 is another turtle: its topics appear anew, as in the original.
        self._drop_endpoints(set(self._endpoints))
        self._sync_endpoints()
        return response

    def _on_spawn(self, request: Any, response: Any) -> Any:
        problem = self._problem_with_name(request.name)
        if problem:
            self.log("ERROR", f"Cannot spawn a turtle named [{request.name}]: {problem}")
            response.name = ""
            return response
        response.name = self.arena.spawn(request.x, request.y, request.theta, request.name)
        self._sync_endpoints()
        return response

    def _on_kill(self, request: Any, response: Any) -> Any:
        self.arena.kill(request.name)
        self._sync_endpoints()
        return response

    def accepts_goal(self) -> bool:
        """Whether a rotation goal is accepted; like the original, always."""
        return True

    # Helpers ----------------------------------------------------------------------------------

    def _problem_with_name(self, name: str) -> str:
        """Return why no topic can have this turtle name; '' where it can."""
        if not name:
            return ""
        try:
            full = expand_topic_name(name + LONGEST_SUFFIX, self.get_name(), self.get_namespace())
            validate_full_topic_name(full, is_service=True)
        except (ValueError, NameValidationException) as error:
            return str(error).replace("\n", " ").strip()
        return ""

    def _sync_endpoints(self) -> None:
        """Give every turtle of the arena its endpoints and destroy those of the others."""
        self._drop_endpoints(self._endpoints.keys() - self.arena.turtles.keys())
        for name in self.arena.turtles:
            if name not in self._endpoints:
                self._endpoints[name] = TurtleEndpoints(
                    self, self.interfaces, self.arena, name, self.accepts_goal
                )

    def _drop_endpoints(self, names: set[str]) -> None:
        for name in names:
            self._endpoints.pop(name).destroy()

    def _on_notice(self, notice: Notice) -> None:
        match notice:
            case LogLine(severity, text):
                self.log(severity, text)
            case GoalFeedback(turtle) | GoalResult(turtle):
                action = self._endpoints[turtle].action
                send: Any = action.feedback if isinstance(notice, GoalFeedback) else action.finish
                try:
                    send(notice)
                except Exception as error:  # in the middle of a tick, which goes on
                    self.on_failure(f"{turtle}/rotate_absolute", error)

    def _log_positions(self) -> None:
        for name in sorted(self.arena.turtles):
            turtle = self.arena.turtles[name]
            numbers = (turtle.x_m, turtle.y_down_m, turtle.heading_rad)
            x, y, theta = map(printf_f, numbers)
            # The brackets have the namespace, not the turtle, as in the original.
            self.log("DEBUG", f"[{self.get_namespace()}]: pos_x: {x} pos_y: {y} theta: {theta}")


def simulate(node: TurtlesimNode, stopped: Callable[[], bool]) -> None:
    """Let the clock that the node follows move the turtles until it is stopped."""
    node.tick_executor.rely_on_arrivals()
    if not node.follows_ros_clock:
        node.tick(time.time_ns())  # before the window: a program may be waiting for the first pose
    node.open_window()
    name = node.get_fully_qualified_name()
    node.log(
        "INFO",
        f"This turtlesim shows no window, but a page: {node.live.address}"
        if node.live is not None
        else f"This turtlesim shows no window. To see it: ros2 run rqt_image_view rqt_image_view "
        f"{name}/image, or as a file: ros2 service call {name}/save_canvas std_srvs/srv/Trigger",
    )
    # What exists now stays, with hardly any garbage: no search through it in the middle of a tick
    gc.freeze()

    def goes_on(with_ros_clock: bool, _: object) -> bool:
        return not stopped() and node.follows_ros_clock == with_ros_clock

    while not stopped():
        if node.follows_ros_clock:
            program.follow_ros_clock(
                node.hear_clock,
                lambda: goes_on(True, node.serve()),
                lambda now_ns: goes_on(True, node.tick(now_ns)),
            )
        else:
            # the time of the node's clock, which takes ten times as long to ask
            program.follow_wall_clock(lambda: goes_on(False, node.tick(time.time_ns())))


def main(argv: list[str] | None = None) -> int:
    """Run the simulator until SIGINT or SIGTERM; 2 where its arguments cannot be used."""
    return program.run(
        "turtlesim_node", partial(TurtlesimNode, opens_window=False), simulate, argv, ABOUT
    )


if __name__ == "__main__":
    sys.exit(main())
