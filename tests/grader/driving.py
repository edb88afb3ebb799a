"""The reference's behaviour as a function of the pose, for tests to drive and to spoil."""

from __future__ import annotations

from typing import Any

from grader.scenes.turtlesim.driving import REST_TICKS, pen, twist
from grader.testing import drive
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.turtle import SIZE_M, Pose

__all__ = ["BLUE", "CENTRE", "GREEN", "RED", "REST_TICKS", "WHITE", "Spiral", "spoiled"]
__all__ += ["drive", "pen", "twist"]  # as grader.testing has them

CENTRE = SIZE_M / 2
WHITE, RED, GREEN, BLUE = (255, 255, 255), (255, 0, 0), (0, 255, 0), (0, 0, 255)


class Spiral:
    """The reference's behaviour; a subclass spoils one part of it."""

    colors = {1: WHITE, 2: RED, 3: GREEN, 4: BLUE}

    def __init__(self) -> None:
        self.speed = 0.0
        self.quadrant = 0
        self.stopped = False

    def __call__(self, tick: int, pose: Pose | None, arena: Arena) -> None:
        if pose is not None and not self.stopped:
            self.watch(tick, pose, arena)
        if tick % 31 == 1 and not self.stopped:
            self.drive(tick, arena)

    def drive(self, tick: int, arena: Arena) -> None:
        self.speed += 0.05
        twist(arena, self.speed)

    def watch(self, tick: int, pose: Pose, arena: Arena) -> None:
        if self.near_edge(tick, pose):
            self.stop(arena)
            return
        quadrant = self.quadrant_of(pose)
        if quadrant != self.quadrant:
            self.quadrant = quadrant
            self.entered(quadrant, arena)

    def near_edge(self, tick: int, pose: Pose) -> bool:
        return min(pose.x, pose.y, SIZE_M - pose.x, SIZE_M - pose.y) < 0.5

    def stop(self, arena: Arena) -> None:
        self.stopped = True
        twist(arena, 0.0, 0.0)

    def quadrant_of(self, pose: Pose) -> int:
        if pose.y >= CENTRE:
            return 1 if pose.x >= CENTRE else 2
        return 3 if pose.x < CENTRE else 4

    def entered(self, quadrant: int, arena: Arena) -> None:
        pen(arena, self.colors[quadrant])


def spoiled(base: type[Spiral] = Spiral, **parts: Any) -> type[Spiral]:
    """Return a class that behaves as another one but for some parts: its methods, its colours."""
    return type("Spoiled", (base,), parts)
