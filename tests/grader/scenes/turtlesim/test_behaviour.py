"""Two that did the same to turtlesim have the same behaviour."""

import numpy as np

from grader.scenes.turtlesim.scene import SCENE
from tests.grader.driving import Spiral, drive, pen, twist
from turtlesim_py.world.arena import TICK_NS


def behaviour(controller, ticks=50):
    return SCENE.behaviour(drive(controller, ticks).trace)


def test_commands_have_their_time_and_what_the_node_takes_of_them():
    def controller(tick, pose, arena):
        if tick == 3:
            twist(arena, 2.0, 0.5)
        if tick == 5:
            pen(arena, (255, 0, 0), 4)

    commands = behaviour(controller).commands
    assert commands == (
        (3 * TICK_NS, "cmd_vel", (2.0, 0.0, 0.5)),
        (5 * TICK_NS, "set_pen", (255.0, 0.0, 0.0, 4.0, 0.0)),
    )


def test_a_way_ends_where_it_is_no_longer_anywhere():
    def controller(tick, pose, arena):
        twist(arena, 1.0 if tick < 10 else float("nan"))

    path = behaviour(controller).path
    assert path.shape == (9, 2) and np.isfinite(path).all()


def test_equal_runs_behave_equally():
    one, other = behaviour(Spiral(), 500), behaviour(Spiral(), 500)
    assert one.commands == other.commands and (one.path == other.path).all()
