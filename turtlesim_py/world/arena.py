"""The turtles by name and everything that can be done to them."""

from __future__ import annotations

import random
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from typing import Any

from turtlesim_py.world import events
from turtlesim_py.world.canvas import Canvas
from turtlesim_py.world.events import LogLine, Notice, Severity
from turtlesim_py.world.floats import float32, printf_f
from turtlesim_py.world.turtle import METER_PX, SIZE_M, SPRITES, Reading, Sprite, Teleport, Turtle

#: A tick's length on the arena's clock [ns].
TICK_NS = 16_000_000
DEFAULT_BACKGROUND = (69, 86, 255)


@dataclass(frozen=True)
class ArenaParameter:
    """A parameter of the simulator; `limits` are the least and the largest whole number."""

    name: str
    default: bool | int
    description: str
    limits: tuple[int, int] | None = None


#: Those of the original, in its order of declaration.
PARAMETERS = (
    *(
        ArenaParameter(
            f"background_{name[0].lower()}",
            default,
            f"{name} channel of the background color",
            (0, 255),
        )
        for name, default in zip(("Red", "Green", "Blue"), DEFAULT_BACKGROUND, strict=True)
    ),
    ArenaParameter("holonomic", False, "If true, then turtles will be holonomic"),
)
BY_NAME = {parameter.name: parameter for parameter in PARAMETERS}
TYPE_NAMES = {bool: "bool", int: "integer", float: "double", str: "string"}


def wrong_type(name: str, expected: str, found: str) -> str:
    """Return the original's refusal to change a parameter's type."""
    return (
        f"Wrong parameter type, parameter {{{name}}} is of type {{{expected}}}, "
        f"setting it to {{{found}}} is not allowed."
    )


def refusal(parameter: ArenaParameter, value: object) -> str:
    """Return why the original would not set this value; '' where it would."""
    kinds = type(parameter.default), type(value)
    expected, found = (TYPE_NAMES.get(kind, kind.__name__) for kind in kinds)
    if found != expected:
        return wrong_type(parameter.name, expected, found)
    if parameter.limits:
        assert isinstance(value, int)
        least, most = parameter.limits
        if not least <= value <= most:
            return f"Parameter {{{parameter.name}}} doesn't comply with integer range."
    return ""


class UnknownTurtle(KeyError):
    """No turtle has this name."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name

    def __str__(self) -> str:
        return f"there is no turtle named {self.name!r}"


class Arena:
    """Turtles on a canvas; a plain object that knows no time but `now_ns`.

    Attributes:
        turtles: name -> turtle. `tick` visits them in the byte-wise order of their names.
        canvas: what the pens have drawn, 500 x 500 pixels.
        listeners: called with every `Notice`, in the order in which things happen.
        now_ns: the time [ns] at which inputs arrive and the watchdog runs. The owner sets it
            before each tick; left alone, it advances by 16 ms a tick.
        ticks: how often the turtles have been updated.
        holonomic: whether linear.y of a command counts.
        speed_factor, turn_factor: every turtle drives so many times as fast, and turns so many
            times as fast, as it is commanded; 1 as in the original. Only a grader changes them.
        background: (r, g, b) under the drawing; no turtle ever sees it.
    """

    def __init__(
        self, listeners: tuple[Callable[[Notice], None], ...] = (), sprite: str = ""
    ) -> None:
        """Create the arena with turtle1 in its centre; `sprite` fixes every turtle's picture."""
        self.turtles: dict[str, Turtle] = {}
        self.canvas = Canvas()
        self.listeners: list[Callable[[Notice], None]] = list(listeners)
        self.now_ns = 0
        self.ticks = 0
        self.holonomic = False
        self.speed_factor = self.turn_factor = 1.0
        self.background = DEFAULT_BACKGROUND
        self.sprite = sprite
        self._id_counter = 0
        self._spawn_first()

    # Inputs: each is reported to the listeners before it acts -----------------------------------

    def command(
        self,
        turtle: str,
        linear: tuple[float, float, float],
        angular: tuple[float, float, float],
    ) -> None:
        """Drive a turtle; only linear x, angular z and, if holonomic, linear y count.

        Raises:
            UnknownTurtle: nobody has this name.
        """
        self._report(events.CmdVel, turtle=turtle, linear=linear, angular=angular)
        speed, turn = self.speed_factor, self.turn_factor
        linear_y = linear[1] * speed if self.holonomic else None
        self._get(turtle).command(linear[0] * speed, linear_y, angular[2] * turn, self.now_ns)

    def set_pen(self, turtle: str, r: int, g: int, b: int, width: int, off: int) -> None:
        """Change a turtle's pen: colour and width [px], each 0-255; `off` other than 0 lifts it."""
        self._report(events.SetPen, turtle=turtle, r=r, g=g, b=b, width=width, off=off)
        self._get(turtle).set_pen(r, g, b, width, off)

    def teleport_absolute(self, turtle: str, x: float, y: float, theta: float) -> None:
        """Put a turtle at (x, y) [m] with heading theta [rad] at the next tick."""
        self._report(events.TeleportAbsolute, turtle=turtle, x=x, y=y, theta=theta)
        self._get(turtle).teleport(Teleport(x, y, theta, relative=False))

    def teleport_relative(self, turtle: str, linear: float, angular: float) -> None:
        """Turn by `angular` [rad], then go ahead by `linear` [m], at the next tick."""
        self._report(events.TeleportRelative, turtle=turtle, linear=linear, angular=angular)
        self._get(turtle).teleport(Teleport(linear, 0.0, angular, relative=True))

    def rotate_absolute(self, turtle: str, theta: float, goal_id: object) -> None:
        """Start a rotation goal towards heading theta [rad]."""
        self._report(events.RotateAbsolute, turtle=turtle, theta=theta, id=goal_id)
        self._get(turtle).rotate_to(goal_id, theta)

    def cancel(self, goal_id: object) -> bool:
        """Ask for the end of a goal; False where it is not running (any more)."""
        self._report(events.Cancel, id=goal_id)
        for turtle in self.turtles.values():
            goal = turtle.goal
            if goal is not None and goal.goal_id == goal_id:
                goal.cancel_requested = True
                return True
        return False

    def spawn(self, x: float, y: float, theta: float, name: str = "") -> str:
        """Add a turtle at (x, y) [m], theta [rad], and return its name; '' where it is in use.

        An empty name becomes "turtleN" with the next free N.
        """
        self._report(events.Spawn, x=x, y=y, theta=theta, name=name)
        if name in self.turtles:
            self._log("ERROR", f"A turtle named [{name}] already exists")
            return ""
        return self._spawn(float32(x), float32(y), float32(theta), name or self._free_name())

    def kill(self, name: str) -> bool:
        """Remove a turtle; False where there is none of that name."""
        self._report(events.Kill, name=name)
        turtle = self.turtles.pop(name, None)
        if turtle is None:
            self._log("ERROR", f"Tried to kill turtle [{name}], which does not exist")
            return False
        turtle.abandon_goal()
        return True

    def clear(self) -> None:
        """Wipe the drawing; turtles, pens and parameters stay."""
        self._report(events.Clear)
        self._log("INFO", "Clearing turtlesim.")
        self.canvas.clear()

    def reset(self) -> None:
        """Start again with turtle1 in the centre and an empty canvas; parameters stay."""
        self._report(events.Reset)
        self._log("INFO", "Resetting turtlesim.")
        for turtle in self.turtles.values():
            turtle.abandon_goal()
        self.turtles.clear()
        self._id_counter = 0
        self._spawn_first()
        self.canvas.clear()

    def set_parameter(self, name: str, value: bool | int) -> None:
        """Set a parameter to a value that `refusal` accepts."""
        self._report(events.SetParameter, name=name, value=value)
        if name == "holonomic":
            self.holonomic = bool(value)
        else:
            channel = "rgb".index(name.removeprefix("background_"))
            colors = list(self.background)
            colors[channel] = int(value)
            self.background = (colors[0], colors[1], colors[2])

    def begin_at(
        self, x: float, y: float, theta: float, speed: float = 1.0, turn: float = 1.0
    ) -> None:
        """Put turtle1 at (x, y) [m] with heading theta [rad], without a stroke, before a run.

        Args:
            speed, turn: see `speed_factor` and `turn_factor`.
        """
        self.turtles["turtle1"].place(x, y, theta)
        self.speed_factor, self.turn_factor = speed, turn

    # Time and views ---------------------------------------------------------------------------

    def tick(self) -> dict[str, Reading]:
        """Update every turtle once; return what each publishes, in the order of the updates."""
        readings = {
            name: self.turtles[name].update(self.canvas, self.now_ns)
            for name in sorted(self.turtles)
        }
        self.ticks += 1
        self.now_ns += TICK_NS
        return readings

    def twins(self) -> list[Turtle] | None:
        """Copies of the turtles, in the order of the updates, to be asked where they will be.

        None where one of them will do more than move.
        """
        turtles = [self.turtles[name] for name in sorted(self.turtles)]
        return None if any(t.is_busy for t in turtles) else list(map(copy, turtles))

    def sprites(self) -> list[Sprite]:
        """Return the place of each turtle's picture on the canvas, later ones on top."""
        ordered = (self.turtles[name] for name in sorted(self.turtles))
        return [
            Sprite(t.x_m * METER_PX, t.y_down_m * METER_PX, t.heading_rad, t.sprite)
            for t in ordered
        ]

    # Helpers ----------------------------------------------------------------------------------

    def _get(self, name: str) -> Turtle:
        try:
            return self.turtles[name]
        except KeyError:
            raise UnknownTurtle(name) from None

    def _spawn_first(self) -> None:
        centre = float32(SIZE_M / 2.0)
        self._spawn(centre, centre, 0.0, self._free_name())

    def _spawn(self, x: float, y: float, theta: float, name: str) -> str:
        where = f"x=[{printf_f(x)}], y=[{printf_f(y)}], theta=[{printf_f(theta)}]"
        self._log("INFO", f"Spawning turtle [{name}] at {where}")
        sprite = self.sprite or random.choice(SPRITES)
        self.turtles[name] = Turtle(name, x, y, theta, self.now_ns, self._emit, sprite)
        return name

    def _free_name(self) -> str:
        while True:
            self._id_counter += 1
            name = f"turtle{self._id_counter}"
            if name not in self.turtles:
                return name

    def _report(self, kind: type[events.Event], **fields: Any) -> None:
        self._emit(kind(tick=self.ticks + 1, **fields))

    def _emit(self, notice: Notice) -> None:
        for listener in self.listeners:
            listener(notice)

    def _log(self, severity: Severity, text: str) -> None:
        self._emit(LogLine(severity, text))
