"""No right controller of the challenge loses a point, whatever its style: an oracle apart."""

from __future__ import annotations

import math
import random

import pytest

from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.recording.recording import Recordings
from grader.scenes.turtlesim.driving import pen, twist
from grader.testing import drive
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


class Controller:
    """Drives as a right submission of some style would; in ticks, m and rad."""

    def __init__(self, seed: int) -> None:
        chance = random.Random(seed)
        # whether it uses the pose only when it publishes
        self.one_timer = chance.random() < 0.3
        turn = chance.choice((0.8, 1.0, 1.2, 1.5, 2.0))
        # a pose that is looked at every 0.3 s, and a pen that is answered in 0.06 s, are in time
        self.period = chance.choice((6, 12, 19) if self.one_timer else (3, 6, 12, 31, 50))
        per_turn = chance.uniform(0.2, 0.8)  # by so much the radius grows with each turn
        commands = 2 * math.pi / turn / (self.period * TICK_S)
        self.colors = [chance.choice(row) for row in PALETTES]
        chance.shuffle(self.colors)
        self.turn = turn * chance.choice((1, 1, -1))
        self.speed = chance.choice((0.0, 0.0, 0.1, 0.3)) * turn
        self.growth = per_turn * turn / commands
        self.margin_m = chance.uniform(1.0, 2.0) if self.one_timer else chance.uniform(0.3, 1.5)
        self.answer = chance.randrange(0, 5)  # until the pen has changed
        self.repeats_zeros = chance.random() < 0.4
        self.direction = -1 if chance.random() < 0.1 else 1
        self.waits = chance.choice((0, 0, 0, 30, 300))
        self.next_at = self.waits + 1
        self.quadrant = 0
        self.is_stopped = False
        self.due: dict[int, tuple[int, int, int]] = {}

    def __call__(self, tick: int, pose: Pose | None, arena: Arena) -> None:
        for when in [when for when in self.due if when <= tick]:
            pen(arena, self.due.pop(when))
        is_due = tick >= self.next_at
        if tick < self.waits or pose is None or (self.one_timer and not is_due):
            return
        if not self.is_stopped:
            self._watch(tick, pose, arena)
        if is_due:
            self.next_at = tick + self.period
            self._publish(arena)

    def _publish(self, arena: Arena) -> None:
        if not self.is_stopped:
            self.speed += self.growth
            twist(arena, self.direction * self.speed, self.turn)
        elif self.repeats_zeros:
            twist(arena, 0.0, 0.0)

    def _watch(self, tick: int, pose: Pose, arena: Arena) -> None:
        if min(pose.x, pose.y, SIZE_M - pose.x, SIZE_M - pose.y) < self.margin_m:
            self.is_stopped = True
            twist(arena, 0.0, 0.0)
            return
        quadrant = _quadrant(pose)
        if quadrant != self.quadrant:
            self.quadrant = quadrant
            self.due[tick + self.answer] = self.colors[quadrant - 1]


def _quadrant(pose: Pose) -> int:
    if pose.y >= CENTRE_M:
        return 1 if pose.x >= CENTRE_M else 2
    return 3 if pose.x < CENTRE_M else 4


def lost(seed: int) -> set[str]:
    ticks = round(EXERCISE.limits.total_s / TICK_S)
    starts = (None, *EXERCISE.starts())
    nominal, *varied = (drive(Controller(seed), ticks, start) for start in starts)
    runs = Recordings(nominal, tuple(varied))
    verdicts = judge(runs, EXERCISE.checks, EXERCISE.points, EXERCISE.tolerances)
    return {verdict.check for verdict in verdicts if verdict.score < verdict.max_score}


@pytest.mark.timeout(0)
def test_no_right_controller_loses_a_point():
    found = {seed: lost(seed) for seed in range(max(3, EXAMPLES))}
    assert {seed: checks for seed, checks in found.items() if checks} == {}
