"""Recordings made without ROS: a controller function drives the real world, tick by tick."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from grader.recording.recording import Recording, Start
from grader.scenes.turtlesim.recorder import Recorder
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.turtle import SIZE_M, Pose

CENTRE = SIZE_M / 2
REST_TICKS = 188
WHITE, RED, GREEN, BLUE = (255, 255, 255), (255, 0, 0), (0, 255, 0), (0, 0, 255)

#: (tick, latest pose or None, arena) -> nothing; called before each tick, as callbacks would be.
Controller = Callable[[int, Pose | None, Arena], None]


def drive(controller: Controller, ticks: int = 4000, start: Start | None = None) -> Recording:
    """Let a controller drive until the turtle has rested for three seconds, or for `ticks`."""
    arena = Arena(sprite="rolling")
    if start is not None:
        arena.turtles["turtle1"].place(start.x, start.y, start.theta)
    recorder = Recorder(arena)
    pose: Pose | None = None
    still = 0
    for tick in range(1, ticks + 1):
        controller(tick, pose, arena)
        readings = arena.tick()
        recorder.take(readings)
        before, pose = pose, readings["turtle1"].pose
        still = still + 1 if before is not None and before[:3] == pose[:3] else 0
        if still == REST_TICKS and recorder.ticks > 2 * REST_TICKS:
            break
    recording = recorder.recording()
    outcome = "finished" if still >= REST_TICKS else "time_limit"
    return replace(recording, start=start).finished(outcome=outcome)


def twist(arena: Arena, speed: float, turn: float = 1.0) -> None:
    """Publish a velocity command."""
    arena.command("turtle1", (speed, 0.0, 0.0), (0.0, 0.0, turn))


def pen(arena: Arena, color: tuple[int, int, int], width: int = 3) -> None:
    """Call set_pen."""
    arena.set_pen("turtle1", *color, width, 0)


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
