"""The ROS face of an arena: topics, services, action, parameters, logs."""

from __future__ import annotations

import signal
import sys
from pathlib import Path
from typing import Any

import rclpy
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.expand_topic_name import expand_topic_name
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from rclpy.validate_full_topic_name import validate_full_topic_name
from std_srvs.srv import Empty, Trigger
from turtlesim.srv import Kill, Spawn

from turtlesim_py import pacer
from turtlesim_py.executor import TickExecutor
from turtlesim_py.turtle_endpoints import TurtleEndpoints
from turtlesim_py.world import picture
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.events import Event, GoalFeedback, GoalResult, LogLine
from turtlesim_py.world.parameters import BY_NAME, PARAMETERS, refusal
from turtlesim_py.world.sprites import NAMES
from turtlesim_py.world.turtle import Reading

#: The longest name that rotate_absolute's hidden services add to a turtle's.
LONGEST_SUFFIX = "/rotate_absolute/_action/cancel_goal"


class TurtlesimNode(Node):
    """The node `/turtlesim`: owns an arena and serves it; somebody else calls `tick`.

    Args:
        arguments: ROS arguments (`--ros-args ...`) of this node alone; the global ones count too.

    Raises:
        InvalidParameterValueException, InvalidParameterTypeException: a parameter override is
            out of range or of the wrong type.
    """

    def __init__(self, arguments: list[str] | None = None) -> None:
        super().__init__("turtlesim", cli_args=arguments)
        self.arena: Arena
        self._endpoints: dict[str, TurtleEndpoints] = {}
        for parameter in PARAMETERS:
            descriptor = ParameterDescriptor(description=parameter.description)
            if parameter.low is not None and parameter.high is not None:
                channel = IntegerRange(from_value=parameter.low, to_value=parameter.high, step=1)
                descriptor.integer_range = [channel]
            self.declare_parameter(parameter.name, parameter.default, descriptor)
        sprite = self._declare_own_parameters()
        self.get_logger().info(
            f"Starting turtlesim with node name {self.get_fully_qualified_name()}"
        )
        self.arena = Arena((self._on_event,), sprite=sprite)
        for parameter in PARAMETERS:
            self.arena.set_parameter(parameter.name, self.get_parameter(parameter.name).value)
        self.arena.now_ns = self.get_clock().now().nanoseconds
        self._sync_endpoints()
        self.add_post_set_parameters_callback(self._on_parameters)
        self.create_service(Empty, "clear", self._on_clear)
        self.create_service(Empty, "reset", self._on_reset)
        self.create_service(Spawn, "spawn", self._on_spawn)
        self.create_service(Kill, "kill", self._on_kill)
        self.create_service(Trigger, "~/save_canvas", self._on_save_canvas)
        self.executor_once_a_tick = TickExecutor(self)

    def tick(self) -> dict[str, Reading]:
        """Serve what has arrived, update the turtles, publish; return what was published."""
        self.arena.now_ns = self.get_clock().now().nanoseconds
        self.executor_once_a_tick.spin_some()
        readings = self.arena.tick()
        for name, reading in readings.items():
            self._endpoints[name].publish(reading)
        return readings

    # Parameters -------------------------------------------------------------------------------

    def _declare_own_parameters(self) -> str:
        """Declare what the original does not have; return the picture for every turtle."""
        self.declare_parameter(
            "canvas_folder", ".", ParameterDescriptor(description="Where save_canvas writes")
        )
        sprite = self.declare_parameter(
            "turtle_image",
            "",
            ParameterDescriptor(
                description=f"Picture of every turtle ({', '.join(NAMES)}); empty: a random one",
                read_only=True,
            ),
        ).value
        if sprite and sprite not in NAMES:
            raise InvalidParameterValueException(
                "turtle_image", sprite, f"expected one of {', '.join(NAMES)}"
            )
        return str(sprite)

    def _apply_descriptor(
        self, parameter: Parameter, *args: Any, **kwargs: Any
    ) -> SetParametersResult:
        """Refuse in the original's words instead of rclpy's."""
        result = super()._apply_descriptor(parameter, *args, **kwargs)
        if not result.successful and parameter.name in BY_NAME:
            result.reason = refusal(BY_NAME[parameter.name], parameter.value) or result.reason
        return result

    def _on_parameters(self, parameters: list[Parameter]) -> None:
        for parameter in parameters:
            if parameter.name in BY_NAME:
                self.arena.set_parameter(parameter.name, parameter.value)

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
            self.get_logger().error(f"Cannot spawn a turtle named [{request.name}]: {problem}")
            response.name = ""
            return response
        response.name = self.arena.spawn(request.x, request.y, request.theta, request.name)
        self._sync_endpoints()
        return response

    def _on_kill(self, request: Any, response: Any) -> Any:
        self.arena.kill(request.name)
        self._sync_endpoints()
        return response

    def _on_save_canvas(self, _: Any, response: Any) -> Any:
        folder = Path(self.get_parameter("canvas_folder").value).expanduser().resolve()
        try:
            folder.mkdir(parents=True, exist_ok=True)
            path = _next_free(folder)
            arena = self.arena
            picture.save_png(picture.render(arena.canvas, arena.background, arena.sprites()), path)
        except OSError as error:
            response.success = False
            response.message = f"cannot write the canvas to {folder}: {error.strerror}"
        else:
            response.success = True
            response.message = str(path)
        return response

    # Helpers ----------------------------------------------------------------------------------

    def _problem_with_name(self, name: str) -> str:
        """Why no topics can carry this turtle name; '' where they can."""
        if not name:
            return ""
        try:
            full = expand_topic_name(name + LONGEST_SUFFIX, self.get_name(), self.get_namespace())
            validate_full_topic_name(full, is_service=True)
        except (ValueError, rclpy.exceptions.NameValidationException) as error:
            return str(error).replace("\n", " ").strip()
        return ""

    def _sync_endpoints(self) -> None:
        """Give every turtle of the arena its endpoints and take away those of the others."""
        self._drop_endpoints(self._endpoints.keys() - self.arena.turtles.keys())
        for name in self.arena.turtles:
            if name not in self._endpoints:
                self._endpoints[name] = TurtleEndpoints(self, self.arena, name)

    def _drop_endpoints(self, names: set[str]) -> None:
        for name in names:
            self._endpoints.pop(name).destroy()

    def _on_event(self, event: Event) -> None:
        match event:
            case LogLine(severity, text):
                logger = self.get_logger()
                # One call a severity: rclpy refuses a call site that changes its severity.
                if severity == "INFO":
                    logger.info(text)
                elif severity == "WARN":
                    logger.warning(text)
                else:
                    logger.error(text)
            case GoalFeedback(turtle):
                self._endpoints[turtle].feedback(event)
            case GoalResult(turtle):
                self._endpoints[turtle].finish(event)


def _next_free(folder: Path) -> Path:
    """canvas_001.png, or the first number that is not taken yet."""
    number = 1
    while (path := folder / f"canvas_{number:03}.png").exists():
        number += 1
    return path


def main(argv: list[str] | None = None) -> int:
    """Run the simulator until SIGINT or SIGTERM; 2 where its parameters cannot be used."""
    stop = False

    def on_signal(*_: Any) -> None:
        nonlocal stop
        stop = True

    signal.signal(signal.SIGINT, on_signal)
    signal.signal(signal.SIGTERM, on_signal)
    rclpy.init(args=argv, signal_handler_options=SignalHandlerOptions.NO)
    try:
        node = TurtlesimNode()
    except (InvalidParameterValueException, InvalidParameterTypeException) as error:
        print(f"turtlesim_node: {error}", file=sys.stderr)
        rclpy.shutdown()
        return 2

    def tick() -> bool:
        node.tick()
        return not stop

    pacer.follow_wall_clock(tick)
    node.destroy_node()
    rclpy.shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
