"""One turtle: motion, watchdog, teleports, rotation goal and pen, by the original's arithmetic.

Every expression keeps the order of operations of turtlesim 1.8.4, because published values are
compared bit for bit. Positions are metres with y growing DOWN, as inside the original; `Pose`
is what it publishes, y growing up.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from turtlesim_py.world.canvas import Canvas, Pen
from turtlesim_py.world.events import GoalFeedback, GoalResult, GoalStatus, LogLine, Notice
from turtlesim_py.world.floats import (
    cos,
    float32,
    fuzzy_equal,
    normalize_angle,
    printf_f,
    sin,
)

#: Pixels in a metre: the height of the original's turtle pictures.
METER_PX = 45.0
#: Width and height of the arena [m]: float32((500 - 1) / 45).
SIZE_M = float32(499.0 / METER_PX)
#: A tick's length in the equations of motion [s]; the original never measures it.
TICK_S = 0.001 * 16
#: A velocity command moves the turtle for this long [ns].
COMMAND_TIMEOUT_NS = 1_000_000_000
#: A rotation goal is reached when less than this is left [rad].
GOAL_TOLERANCE_RAD = 0.02
#: The names of the turtles' pictures, in the original's order.
SPRITES = (
    *("ardent", "bouncy", "crystal", "dashing", "eloquent", "foxy", "galactic", "humble"),
    *("iron", "jazzy", "rolling"),
)


class Pose(NamedTuple):
    """A published pose: x, y [m], theta [rad], speeds [m/s, rad/s]; each a float32 value."""

    x: float
    y: float
    theta: float
    linear_velocity: float
    angular_velocity: float


class Reading(NamedTuple):
    """The values that a turtle publishes in a tick: its pose and the colour (r, g, b) under it."""

    pose: Pose
    color: tuple[int, int, int]


@dataclass(frozen=True)
class Sprite:
    """A turtle as the window shows it.

    Attributes:
        x_px, y_px: its centre on the canvas, y down. Where one is not finite, the edge of the
            turtle's picture lies on the edge of the window, as in the original.
        heading_rad: 0 is to the right, positive turns to the left. A turtle whose heading is
            not finite is invisible, as in the original.
        name: one of `SPRITES`.
    """

    x_px: float
    y_px: float
    heading_rad: float
    name: str


class Teleport(NamedTuple):
    """A jump that waits for the next update. Relative: x is the way ahead [m], y unused."""

    x: float
    y: float
    theta: float
    relative: bool


@dataclass(slots=True)
class RotationGoal:
    """A rotation towards `theta` [rad]; `goal_id` is the caller's."""

    goal_id: object
    theta: float
    start: float
    delta: float = 0.0
    cancel_requested: bool = False


class Turtle:
    """A turtle at (x, y) [m, y up, float32] with heading theta [rad, float32]."""

    def __init__(
        self,
        name: str,
        x: float,
        y: float,
        theta: float,
        now_ns: int,
        emit: Callable[[Notice], None],
        sprite: str = "",
    ) -> None:
        self.name = name
        self.sprite = sprite
        self.place(x, y, theta)
        self.lin_x = 0.0
        self.lin_y = 0.0
        self.ang = 0.0
        self.pen = Pen()
        self.pen_on = True
        self.goal: RotationGoal | None = None
        self._emit = emit
        self._teleports: list[Teleport] = []
        self._last_command_ns = now_ns

    def place(self, x: float, y: float, theta: float) -> None:
        """Stand at (x, y) [m, y up], heading theta [rad], as if spawned there; draws nothing."""
        self.x_m = float32(x)
        self.y_down_m = float32(SIZE_M - float32(y))
        self.heading_rad = float32(theta)
        #: What is published until the next input; None while an update may change something.
        self._rest: Pose | None = None

    # Inputs -----------------------------------------------------------------------------------

    def command(self, linear_x: float, linear_y: float | None, angular: float, now_ns: int) -> None:
        """Obey a velocity command [m/s, rad/s].

        A sideways speed of None leaves the old one acting, as the original does when it is not
        holonomic. Any command aborts a running rotation goal.
        """
        self._rest = None
        self._last_command_ns = now_ns
        self.lin_x = linear_x
        if linear_y is not None:
            self.lin_y = linear_y
        self.ang = angular
        if self.goal is not None:
            self._warn("Velocity command received during rotation goal. Aborting goal")
            self._end_goal("ABORTED", self.goal.delta)

    def set_pen(self, r: int, g: int, b: int, width: int, off: int) -> None:
        """Change the pen at once. Switching it off leaves colour and width as they were."""
        self.pen_on = not off
        if self.pen_on:
            self.pen = Pen(r, g, b, width)

    def teleport(self, teleport: Teleport) -> None:
        """Queue a jump for the next update."""
        self._rest = None
        self._teleports.append(teleport)

    def rotate_to(self, goal_id: object, theta: float) -> None:
        """Start turning to an absolute heading [rad]; an older goal is aborted."""
        if self.goal is not None:
            self._warn(
                "Rotation goal received before a previous goal finished. Aborting previous goal"
            )
            self._end_goal("ABORTED", self.goal.delta)
        self._rest = None
        self.goal = RotationGoal(goal_id, theta, self.heading_rad)

    def abandon_goal(self) -> None:
        """Cancel a running goal without a log line, as when the turtle disappears."""
        if self.goal is not None:
            self._end_goal("CANCELED", 0.0)

    # A tick -----------------------------------------------------------------------------------

    def update(self, canvas: Canvas, now_ns: int) -> Reading:
        """Update for one tick and draw on the canvas; return what is published."""
        if self._rest is not None:
            return Reading(self._rest, self._color(canvas))
        for teleport in self._teleports:
            self._jump(teleport, canvas)
        self._teleports.clear()
        self._pursue_goal(now_ns)
        is_halted = now_ns - self._last_command_ns > COMMAND_TIMEOUT_NS
        if is_halted:
            self._halt()
        old_x, old_y, old_heading = self.x_m, self.y_down_m, self.heading_rad
        self._move()
        self._stay_inside()
        reading = Reading(self._pose(), self._color(canvas))
        self._draw_way(old_x, old_y, canvas)
        # without speed, the same sums leave the same numbers for ever
        if is_halted and (old_x, old_y, old_heading) == (self.x_m, self.y_down_m, self.heading_rad):
            self._rest = reading.pose
        return reading

    def go_to(self, x: float, y: float, theta: float, canvas: Canvas) -> None:
        """Be at (x, y) [m, y up], heading theta [rad]; draw the way there as an update does."""
        old_x, old_y = self.x_m, self.y_down_m
        self.place(x, y, theta)
        self._draw_way(old_x, old_y, canvas)

    @property
    def is_busy(self) -> bool:
        """Whether a jump or a rotation goal waits for the next update."""
        return bool(self._teleports) or self.goal is not None

    def foresee(self, now_ns: int) -> Pose | None:
        """Update for one tick without drawing; None where the turtle hits a wall.

        For a copy of a turtle that is not busy.
        """
        if now_ns - self._last_command_ns > COMMAND_TIMEOUT_NS:
            self._halt()
        self._move()
        if self.x_m < 0.0 or self.x_m > SIZE_M or self.y_down_m < 0.0 or self.y_down_m > SIZE_M:
            return None
        return self._pose()

    def _jump(self, teleport: Teleport, canvas: Canvas) -> None:
        old_x, old_y = self.x_m, self.y_down_m
        if teleport.relative:
            self.heading_rad += teleport.theta
            self.x_m += cos(self.heading_rad) * teleport.x
            self.y_down_m += -sin(self.heading_rad) * teleport.x
        else:
            self.x_m = teleport.x
            # Not Python's max: C++'s max(0.0, NaN) is 0.0. Only this wall is guarded here.
            y_down = SIZE_M - teleport.y
            self.y_down_m = y_down if y_down > 0.0 else 0.0
            self.heading_rad = teleport.theta
        self._draw_from(old_x, old_y, canvas)

    def _pursue_goal(self, now_ns: int) -> None:
        goal = self.goal
        if goal is None:
            return
        if goal.cancel_requested:
            self._emit(LogLine("INFO", "Rotation goal canceled"))
            self._end_goal("CANCELED", goal.delta)
            self._halt()
            return
        theta = normalize_angle(goal.theta)
        heading = float32(self.heading_rad)
        remaining = normalize_angle(theta - heading)
        goal.delta = float32(normalize_angle(float32(goal.start - self.heading_rad)))
        self._emit(GoalFeedback(self.name, goal.goal_id, float32(remaining)))
        if abs(normalize_angle(heading - theta)) < GOAL_TOLERANCE_RAD:
            self._emit(LogLine("INFO", "Rotation goal completed successfully"))
            self._end_goal("SUCCEEDED", goal.delta)
            self._halt()
        else:
            self.lin_x = self.lin_y = 0.0
            self.ang = -1.0 if remaining < 0.0 else 1.0
            self._last_command_ns = now_ns

    def _move(self) -> None:
        """Turn first, then go ahead with the new heading."""
        self.heading_rad = normalize_angle(self.heading_rad + self.ang * TICK_S)
        c, s = cos(self.heading_rad), sin(self.heading_rad)
        self.x_m += c * self.lin_x * TICK_S - s * self.lin_y * TICK_S
        self.y_down_m -= c * self.lin_y * TICK_S + s * self.lin_x * TICK_S

    def _stay_inside(self) -> None:
        """Clamp to the arena; comparisons with NaN are false, so a NaN position stays NaN."""
        x, y = self.x_m, self.y_down_m
        if x < 0.0 or x > SIZE_M or y < 0.0 or y > SIZE_M:
            self._warn(f"Oh no! I hit the wall! (Clamping from [x={printf_f(x)}, y={printf_f(y)}])")
            self.x_m = min(max(x, 0.0), SIZE_M)
            self.y_down_m = min(max(y, 0.0), SIZE_M)

    def _pose(self) -> Pose:
        speed = math.sqrt(self.lin_x * self.lin_x + self.lin_y * self.lin_y)
        place = (self.x_m, SIZE_M - self.y_down_m, self.heading_rad)
        return Pose._make(map(float32, (*place, speed, self.ang)))

    def _color(self, canvas: Canvas) -> tuple[int, int, int]:
        return canvas.color_at(self.x_m * METER_PX, self.y_down_m * METER_PX)

    def _draw_way(self, old_x: float, old_y: float, canvas: Canvas) -> None:
        if not (fuzzy_equal(self.x_m, old_x) and fuzzy_equal(self.y_down_m, old_y)):
            self._draw_from(old_x, old_y, canvas)

    def _draw_from(self, old_x: float, old_y: float, canvas: Canvas) -> None:
        if self.pen_on:
            canvas.draw_line(
                self.x_m * METER_PX,
                self.y_down_m * METER_PX,
                old_x * METER_PX,
                old_y * METER_PX,
                self.pen,
            )

    def _halt(self) -> None:
        self.lin_x = self.lin_y = self.ang = 0.0

    def _end_goal(self, status: GoalStatus, delta: float) -> None:
        assert self.goal is not None
        goal_id, self.goal = self.goal.goal_id, None
        self._emit(GoalResult(self.name, goal_id, status, delta))

    def _warn(self, text: str) -> None:
        self._emit(LogLine("WARN", text))
