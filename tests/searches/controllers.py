"""Controllers of the challenge in random styles, with injected faults: an oracle without checks."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, field

from grader.exercise.check import judge
from grader.exercise.exercise import Exercise
from grader.recording.recording import Recordings
from grader.testing import drive, pen, twist
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.turtle import SIZE_M, TICK_S, Pose

CENTRE_M = SIZE_M / 2
#: What a controller may do wrong -> the checks that it loses points in: it stops after a count,
#: its last two colours are hardly different, it sets the pen at each pose.
FAULTS = {
    "counts": {"edge_stop"},
    "shades": {"pen_per_quadrant", "picture"},
    "every_pose": {"no_redundant_calls"},
}
#: Colours that are easily distinguished, one from each row.
PALETTES = (
    ((255, 255, 255), (0, 0, 0), (255, 255, 0)),
    ((255, 0, 0), (200, 0, 0), (255, 100, 100)),
    ((0, 255, 0), (0, 128, 0), (0, 200, 100)),
    ((0, 0, 255), (0, 0, 128), (128, 0, 255)),
)


@dataclass(frozen=True)
class Style:
    """The style of a controller; without a fault, every style is right.

    Attributes:
        period: ticks between velocity commands.
        turn: angular velocity [rad/s], positive to the left.
        speed, growth: the first linear velocity and what each command adds to it [m/s].
        margin_m: it stops when a wall is nearer.
        one_timer: whether it uses the pose only when it publishes.
        answer: ticks until the pen has changed.
        repeats: whether it goes on publishing zeros.
        backwards: whether it drives backwards.
        waits: ticks before anything.
    """

    period: int
    turn: float
    speed: float
    growth: float
    margin_m: float
    one_timer: bool
    answer: int
    repeats: bool
    backwards: bool
    waits: int
    colors: tuple[tuple[int, int, int], ...]
    fault: str = ""


def some_style(chance: random.Random) -> Style:
    """Draw the style of a right solution."""
    one_timer = chance.random() < 0.3
    turn = chance.choice((0.8, 1.0, 1.2, 1.5, 2.0))
    period = chance.choice((6, 12, 31) if one_timer else (3, 6, 12, 31, 50))
    per_turn = chance.uniform(0.2, 0.8)  # by so much the radius grows with each turn [m]
    commands = 2 * math.pi / turn / (period * TICK_S)
    colors = [chance.choice(row) for row in PALETTES]
    chance.shuffle(colors)
    return Style(
        period=period,
        turn=turn * chance.choice((1, 1, -1)),
        speed=chance.choice((0.0, 0.0, 0.1, 0.3)) * turn,
        growth=per_turn * turn / commands,
        margin_m=chance.uniform(1.0, 2.0) if one_timer else chance.uniform(0.3, 1.5),
        one_timer=one_timer,
        answer=chance.randrange(0, 5),
        repeats=chance.random() < 0.4,
        backwards=chance.random() < 0.1,
        waits=chance.choice((0, 0, 0, 30, 300)),
        colors=tuple(colors),
    )


@dataclass
class Controller:
    """Drives as a submission of that style would."""

    style: Style
    quadrant: int = 0
    is_stopped: bool = False
    due: dict[int, tuple[int, int, int]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.speed = self.style.speed
        self.next_at = self.style.waits + 1

    def __call__(self, tick: int, pose: Pose | None, arena: Arena) -> None:
        """Do what a submission would do before a tick."""
        for when in [when for when in self.due if when <= tick]:
            pen(arena, self.due.pop(when))
        is_due = tick >= self.next_at
        if tick < self.style.waits or pose is None or (self.style.one_timer and not is_due):
            return
        if not self.is_stopped:
            self._watch(tick, pose, arena)
        if is_due:
            self.next_at = tick + self.style.period
            self._publish(arena)

    def _publish(self, arena: Arena) -> None:
        if not self.is_stopped:
            self.speed += self.style.growth
            twist(arena, -self.speed if self.style.backwards else self.speed, self.style.turn)
        elif self.style.repeats:
            twist(arena, 0.0, 0.0)

    def _watch(self, tick: int, pose: Pose, arena: Arena) -> None:
        if self._is_near(pose):
            self.is_stopped = True
            twist(arena, 0.0, 0.0)
            return
        quadrant = _quadrant(pose)
        if quadrant != self.quadrant or self.style.fault == "every_pose":
            self.quadrant = quadrant
            self.due[tick + self.style.answer] = self._color(quadrant)

    def _is_near(self, pose: Pose) -> bool:
        if self.style.fault == "counts":
            return self.speed > 3.2 * abs(self.style.turn)
        return min(pose.x, pose.y, SIZE_M - pose.x, SIZE_M - pose.y) < self.style.margin_m

    def _color(self, quadrant: int) -> tuple[int, int, int]:
        colors = self.style.colors
        if self.style.fault == "shades" and quadrant == 4:
            r, g, b = colors[1]
            return r ^ 1, g ^ 1, b ^ 1
        return colors[quadrant - 1]


def _quadrant(pose: Pose) -> int:
    if pose.y >= CENTRE_M:
        return 1 if pose.x >= CENTRE_M else 2
    return 3 if pose.x < CENTRE_M else 4


def lost(style: Style, exercise: Exercise) -> set[str]:
    """Return the checks in which a controller of this style loses points."""
    ticks = round(exercise.limits.total_s / TICK_S)
    nominal, *varied = (
        drive(Controller(style), ticks, start) for start in (None, *exercise.starts())
    )
    runs = Recordings(nominal, tuple(varied))
    verdicts = judge(runs, exercise.checks, exercise.points, exercise.tolerances)
    return {verdict.check for verdict in verdicts if verdict.score < verdict.max_score}
