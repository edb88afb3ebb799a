"""No right controller of the challenge loses a point, whatever its style: an oracle apart."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, field

import pytest

from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.recording.recording import Recordings
from grader.testing import drive, pen, twist
from tests.conftest import EXAMPLES
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.turtle import SIZE_M, TICK_S, Pose

pytestmark = pytest.mark.more("a search; each check has units of its own")
EXERCISE = load_exercise("turtlesim_challenge")
CENTRE_M = SIZE_M / 2
#: Colours that are easily distinguished, one from each row.
PALETTES = (
    ((255, 255, 255), (0, 0, 0), (255, 255, 0)),
    ((255, 0, 0), (200, 0, 0), (255, 100, 100)),
    ((0, 255, 0), (0, 128, 0), (0, 200, 100)),
    ((0, 0, 255), (0, 0, 128), (128, 0, 255)),
)


@dataclass(frozen=True)
class Style:
    """The style of a right controller.

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


def some_style(chance: random.Random) -> Style:
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
        if quadrant != self.quadrant:
            self.quadrant = quadrant
            self.due[tick + self.style.answer] = self.style.colors[quadrant - 1]

    def _is_near(self, pose: Pose) -> bool:
        return min(pose.x, pose.y, SIZE_M - pose.x, SIZE_M - pose.y) < self.style.margin_m


def _quadrant(pose: Pose) -> int:
    if pose.y >= CENTRE_M:
        return 1 if pose.x >= CENTRE_M else 2
    return 3 if pose.x < CENTRE_M else 4


def lost(style: Style) -> set[str]:
    ticks = round(EXERCISE.limits.total_s / TICK_S)
    starts = (None, *EXERCISE.starts())
    nominal, *varied = (drive(Controller(style), ticks, start) for start in starts)
    runs = Recordings(nominal, tuple(varied))
    verdicts = judge(runs, EXERCISE.checks, EXERCISE.points, EXERCISE.tolerances)
    return {verdict.check for verdict in verdicts if verdict.score < verdict.max_score}


@pytest.mark.timeout(0)
def test_no_right_controller_loses_a_point():
    styles = [some_style(random.Random(number)) for number in range(max(3, EXAMPLES))]
    assert [style for style in styles if lost(style)] == []
