import math

import pytest
from turtlesim.msg import Pose

from tests.programs import Program
from turtlesim_py.programs.draw_square import NEAR_M, SIDE_M, Square
from turtlesim_py.world.arena import Arena


def test_it_drives_along_a_square_and_comes_back():
    arena = Arena()
    goals = []
    square = Square(lambda *goal: goals.append(goal))
    corners = []
    pose = arena.tick()["turtle1"].pose
    start = pose
    for _ in range(10_000):
        before = square.corners
        linear, angular = square.command(pose)
        if square.corners > before:
            corners.append((pose.x, pose.y))
        if square.corners == 5:
            break
        arena.command("turtle1", (linear, 0.0, 0.0), (0.0, 0.0, angular))
        pose = arena.tick()["turtle1"].pose
    expected = [(SIDE_M, 0.0), (SIDE_M, SIDE_M), (0.0, SIDE_M), (0.0, 0.0), (SIDE_M, 0.0)]
    for (x, y), (way_x, way_y) in zip(corners, expected, strict=True):
        # every side ends up to so much short of its goal
        assert math.dist((x, y), (start.x + way_x, start.y + way_y)) < 5 * NEAR_M
    assert len(goals) == 10


def test_the_program_resets_the_simulator_and_drives(graph, simulator):
    begin = len(simulator.lines)
    with Program("turtlesim_py.programs.draw_square") as program:
        simulator.wait_for_line("Resetting turtlesim.", begin)
        line = program.wait_for_line("New goal [")
        assert line.endswith("[draw_square]: New goal [7.544445 5.544445, 0.000000]\n")
        poses = graph.listen(Pose, "/turtle1/pose")
        graph.until(lambda: poses and poses[-1].x > 5.6, "motion")
        assert poses[-1].linear_velocity == pytest.approx(1.0)
        assert program.stop() == 0
        assert "Traceback" not in program.text()
