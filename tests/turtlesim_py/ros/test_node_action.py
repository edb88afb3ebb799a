import time
from dataclasses import dataclass
from typing import Any

import pytest
from action_msgs.msg import GoalStatus
from action_msgs.srv import CancelGoal
from geometry_msgs.msg import Twist
from rclpy.task import Future
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Pose
from turtlesim.srv import Kill, Spawn


@dataclass
class Goal:
    """A goal that a node has accepted, with the feedback of all goals."""

    handle: Any
    result: Future
    feedback: list[Any]

    @property
    def remaining(self):
        own = self.handle.goal_id
        return [each.feedback.remaining for each in self.feedback if each.goal_id == own]


class Rotation:
    def __init__(self, graph, turtle):
        self.graph = graph
        self.client = graph.action(RotateAbsolute, f"/{turtle}/rotate_absolute")
        # by itself: rclpy's client drops what comes together with the result
        topic = f"/{turtle}/rotate_absolute/_action/feedback"
        self.feedback = graph.listen(RotateAbsolute.Impl.FeedbackMessage, topic)

    def send(self, theta):
        sent = self.client.send_goal_async(RotateAbsolute.Goal(theta=theta))
        handle = self.graph.done(sent, "acceptance")
        assert handle.accepted
        return Goal(handle, handle.get_result_async(), self.feedback)

    def outcome(self, goal):
        """Wait for the end of a goal: its status and delta."""
        first = [goal.result]  # asked for when it was sent
        response = self.graph.answered(
            lambda: first.pop() if first else goal.handle.get_result_async(), "a result"
        )
        return response.status, response.result.delta


@pytest.fixture
def rotation(graph, turtle):
    made = Rotation(graph, turtle)
    reached = []  # at once: the turtle looks that way

    def is_heard():
        reached.append(made.send(0.0))
        made.outcome(reached[-1])
        return any(goal.remaining for goal in reached)

    # a server that has not met who listens for feedback sends it to nobody
    graph.until(is_heard, "feedback")
    return made


def test_a_goal_turns_the_turtle_and_stops_just_short(graph, simulator, turtle, rotation):
    poses = graph.listen(Pose, f"/{turtle}/pose")
    begin = len(simulator.lines)
    goal = rotation.send(0.2)
    status, delta = rotation.outcome(goal)
    assert status == GoalStatus.STATUS_SUCCEEDED
    # the original's sign: where it started minus where it is
    assert delta == pytest.approx(-0.192)
    graph.until(lambda: len(goal.remaining) == 13, "a feedback of every tick")
    assert goal.remaining[0] == pytest.approx(0.2)
    assert goal.remaining[-1] == pytest.approx(0.008, abs=1e-6)
    assert simulator.wait_for_line("Rotation goal completed successfully", begin)[:6] == "[INFO]"
    graph.until(lambda: poses[-1].angular_velocity == 0.0, "rest")
    assert poses[-1].theta == pytest.approx(0.192)


def test_a_goal_within_the_tolerance_succeeds_at_once_and_is_then_over(graph, rotation):
    goal = rotation.send(0.01)
    assert rotation.outcome(goal) == (GoalStatus.STATUS_SUCCEEDED, 0.0)
    graph.until(lambda: len(goal.remaining) == 1, "its only feedback")
    answer = graph.done(goal.handle.cancel_goal_async())
    assert answer.return_code == CancelGoal.Response.ERROR_GOAL_TERMINATED
    assert not answer.goals_canceling
    again = graph.done(goal.handle.get_result_async())
    assert (again.status, again.result.delta) == (GoalStatus.STATUS_SUCCEEDED, 0.0)


def test_a_second_goal_aborts_the_first(simulator, rotation):
    begin = len(simulator.lines)
    first = rotation.send(3.0)
    rotation.graph.until(lambda: len(first.remaining) > 3, "a rotation")
    second = rotation.send(0.0)
    status, delta = rotation.outcome(first)
    assert status == GoalStatus.STATUS_ABORTED
    assert delta < 0.0
    line = simulator.wait_for_line("Rotation goal received before a previous goal finished.", begin)
    assert line.startswith("[WARN]")
    assert line.endswith("Aborting previous goal\n")
    assert rotation.outcome(second)[0] == GoalStatus.STATUS_SUCCEEDED


def test_a_canceled_goal_stops_the_turtle(graph, simulator, turtle, rotation):
    poses = graph.listen(Pose, f"/{turtle}/pose")
    begin = len(simulator.lines)
    goal = rotation.send(3.0)
    graph.until(lambda: len(goal.remaining) > 3, "a rotation")
    answer = graph.done(goal.handle.cancel_goal_async())
    assert answer.return_code == CancelGoal.Response.ERROR_NONE
    assert len(answer.goals_canceling) == 1
    status, delta = rotation.outcome(goal)
    assert status == GoalStatus.STATUS_CANCELED
    assert delta < 0.0
    assert simulator.wait_for_line("Rotation goal canceled", begin).startswith("[INFO]")
    graph.until(lambda: poses[-1].angular_velocity == 0.0, "rest")


def test_a_killed_turtles_goal_is_canceled(graph, simulator):
    def of_a_killed_one(name):
        graph.call(Spawn, "/spawn", x=5.0, y=5.0, name=name)
        rotation = Rotation(graph, name)
        goal = rotation.send(3.0)
        graph.until(lambda: len(goal.remaining) > 3, "a rotation")
        graph.call(Kill, "/kill", name=name)
        gives_up = time.monotonic() + 2.0
        graph.until(lambda: goal.result.done() or time.monotonic() > gives_up, "a result")
        return rotation.outcome(goal) if goal.result.done() else None

    # the action goes right after the result, which who hears of the former first does not take
    outcomes = (of_a_killed_one(f"victim{number}") for number in range(10))
    assert next(filter(None, outcomes)) == (GoalStatus.STATUS_CANCELED, 0.0)


def test_goals_of_two_turtles_run_beside_each_other(graph, turtle, rotation):
    graph.call(Spawn, "/spawn", x=5.0, y=5.0, name="second")
    other = Rotation(graph, "second")
    goals = rotation.send(0.2), other.send(-0.2)
    assert rotation.outcome(goals[0])[1] == pytest.approx(-0.192)
    assert other.outcome(goals[1])[1] == pytest.approx(0.192)
    graph.call(Kill, "/kill", name="second")


def test_a_command_aborts_a_goal(graph, simulator, turtle, rotation):
    publisher = graph.publisher(Twist, f"/{turtle}/cmd_vel")
    begin = len(simulator.lines)
    goal = rotation.send(3.0)
    graph.until(lambda: goal.remaining, "a rotation")
    publisher.publish(Twist())
    assert rotation.outcome(goal)[0] == GoalStatus.STATUS_ABORTED
    line = simulator.wait_for_line("Velocity command received during rotation goal.", begin)
    assert line.startswith("[WARN]")
