"""The turtles by name and everything that can be done to them."""

from __future__ import annotations

import random
from collections.abc import Callable
from copy import copy

from turtlesim_py.world.canvas import Canvas
from turtlesim_py.world.events import (
    Cancel,
    Clear,
    CmdVel,
    Kill,
    Reset,
    RotateAbsolute,
    SetParameter,
    SetPen,
    Spawn,
    TeleportAbsolute,
    TeleportRelative,
)
from turtlesim_py.world.floats import float32, printf_f
from turtlesim_py.world.notices import LogLine, Notice, Severity
from turtlesim_py.world.picture import Sprite
from turtlesim_py.world.sprites import NAMES
from turtlesim_py.world.turtle import METER_PX, SIZE_M, Reading, Teleport, Turtle

#: A tick's length on a clock of its own [ns].
TICK_NS = 16_000_000
DEFAULT_BACKGROUND = (69, 86, 255)


class UnknownTurtle(KeyError):
    """No turtle has this name."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name

    def __str__(self) -> str:
        return f"there is no turtle named {self.name!r}"


class Arena:
    """Turtles on a canvas; a plain object that knows no time but the one it is told.

    Attributes:
        turtles: name -> turtle. `tick` visits them in the byte-wise order of their names.
        canvas: what the pens have drawn, 500 x 500 pixels.
        listeners: called with every `Notice`, in the order in which things happen.
        now_ns: the time [ns] at which inputs arrive and the watchdog looks. The owner sets it
            before each tick; left alone, it advances by 16 ms a tick.
        ticks: how often the turtles have been updated.
        holonomic: whether linear.y of a command counts.
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
        self.background = DEFAULT_BACKGROUND
        self.sprite = sprite
        self._id_counter = 0
        self._spawn_first()

    # Inputs: each tells the listeners before it acts -------------------------------------------

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
        self._emit(CmdVel(tick=self.ticks + 1, turtle=turtle, linear=linear, angular=angular))
        linear_y = linear[1] if self.holonomic else None
        self._get(turtle).command(linear[0], linear_y, angular[2], self.now_ns)

    def set_pen(self, turtle: str, r: int, g: int, b: int, width: int, off: int) -> None:
        """Change a turtle's pen: colour and width [px], each 0-255; `off` other than 0 lifts it."""
        self._emit(SetPen(tick=self.ticks + 1, turtle=turtle, r=r, g=g, b=b, width=width, off=off))
        self._get(turtle).set_pen(r, g, b, width, off)

    def teleport_absolute(self, turtle: str, x: float, y: float, theta: float) -> None:
        """Put a turtle at (x, y) [m] with heading theta [rad] at the next tick."""
        self._emit(TeleportAbsolute(tick=self.ticks + 1, turtle=turtle, x=x, y=y, theta=theta))
        self._get(turtle).teleport(Teleport(x, y, theta, relative=False))

    def teleport_relative(self, turtle: str, linear: float, angular: float) -> None:
        """Turn by `angular` [rad], then go ahead by `linear` [m], at the next tick."""
        self._emit(
            TeleportRelative(tick=self.ticks + 1, turtle=turtle, linear=linear, angular=angular)
        )
        self._get(turtle).teleport(Teleport(linear, 0.0, angular, relative=True))

    def rotate_absolute(self, turtle: str, theta: float, goal_id: object) -> None:
        """Start a rotation goal towards heading theta [rad]."""
        self._emit(RotateAbsolute(tick=self.ticks + 1, turtle=turtle, theta=theta, id=goal_id))
        self._get(turtle).rotate_to(goal_id, theta)

    def cancel(self, goal_id: object) -> bool:
        """Ask for the end of a goal; False where it is not running (any more)."""
        self._emit(Cancel(tick=self.ticks + 1, id=goal_id))
        for turtle in self.turtles.values():
            goal = turtle.goal
            if goal is not None and goal.goal_id == goal_id:
                goal.cancel_requested = True
                return True
        return False

    def spawn(self, x: float, y: float, theta: float, name: str = "") -> str:
        """Add a turtle at (x, y) [m], theta [rad], and return its name; '' where the name is taken.

        An empty name becomes "turtleN" with the next free N.
        """
        self._emit(Spawn(tick=self.ticks + 1, x=x, y=y, theta=theta, name=name))
        if name in self.turtles:
            self._log("ERROR", f"A turtle named [{name}] already exists")
            return ""
        return self._spawn(float32(x), float32(y), float32(theta), name or self._free_name())

    def kill(self, name: str) -> bool:
        """Remove a turtle; False where there is none of that name."""
        self._emit(Kill(tick=self.ticks + 1, name=name))
        turtle = self.turtles.pop(name, None)
        if turtle is None:
            self._log("ERROR", f"Tried to kill turtle [{name}], which does not exist")
            return False
        turtle.abandon_goal()
        return True

    def clear(self) -> None:
        """Wipe the drawing; turtles, pens and parameters stay."""
        self._emit(Clear(tick=self.ticks + 1))
        self._log("INFO", "Clearing turtlesim.")
        self.canvas.clear()

    def reset(self) -> None:
        """Start again with turtle1 in the centre and an empty canvas; parameters stay."""
        self._emit(Reset(tick=self.ticks + 1))
        self._log("INFO", "Resetting turtlesim.")
        for turtle in self.turtles.values():
            turtle.abandon_goal()
        self.turtles.clear()
        self._id_counter = 0
        self._spawn_first()
        self.canvas.clear()

    def set_parameter(self, name: str, value: bool | int) -> None:
        """Set a parameter that `turtlesim_py.world.parameters` has found acceptable."""
        self._emit(SetParameter(tick=self.ticks + 1, name=name, value=value))
        if name == "holonomic":
            self.holonomic = bool(value)
        else:
            channel = "rgb".index(name.removeprefix("background_"))
            colors = list(self.background)
            colors[channel] = int(value)
            self.background = (colors[0], colors[1], colors[2])

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
        """Where each turtle's picture belongs on the canvas, later ones on top."""
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
        sprite = self.sprite or random.choice(NAMES)
        self.turtles[name] = Turtle(name, x, y, theta, self.now_ns, self._emit, sprite)
        return name

    def _free_name(self) -> str:
        while True:
            self._id_counter += 1
            name = f"turtle{self._id_counter}"
            if name not in self.turtles:
                return name

    def _emit(self, notice: Notice) -> None:
        for listener in self.listeners:
            listener(notice)

    def _log(self, severity: Severity, text: str) -> None:
        self._emit(LogLine(severity, text))
