"""A robot as a scene: its description, what robot_state_publisher sends of it, and tf."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from typing import Any, Final

from grader.language.phrase import say
from grader.scenes.channel import Channel
from grader.scenes.robot import behaviour, decoding, solid, trace, trying, view
from grader.scenes.robot.endpoints import ENDPOINTS
from grader.scenes.robot.trace import RobotTrace
from grader.scenes.scene import (
    Behaviour,
    Endpoint,
    Hooks,
    Introduction,
    Limits,
    Message,
    Scene,
    Simulation,
    Start,
    Trace,
)
from grader.scenes.view import Pictures, View
from robot_py.robot_state import RefusedDescription, Robot

#: The longest description: it is handed from process to process [characters].
LONGEST_SETTING = 50_000


class RobotScene:
    """See `grader.scenes.scene.Scene`. Its setting is the robot's description, a URDF."""

    name: Final = "robot"
    tick_ns: Final = trace.TICK_NS
    introduction: Final = Introduction(
        nodes=(("robot_state_publisher", "/"),),
        topics=(trace.JOINT_STATES, trace.TF, trace.TF_STATIC),
        services=(),
        compares_stamps=True,
    )
    thing: Final = "robot"
    finished: Final = say("the robot was watched to the end")
    examiner: Final = ""
    plane: Final = view.PLANE
    window_is_plane: Final = False
    the_thing: Final = say("the robot")
    farthest_start_m: Final = 0.0

    def wrong_setting(self, setting: str) -> str:
        """Whether robot_state_publisher takes it."""
        if len(setting) > LONGEST_SETTING:
            return say(
                "expected {most} characters at most, found {count}",
                most=LONGEST_SETTING,
                count=len(setting),
            )
        try:
            Robot.of(setting)
        except RefusedDescription as error:
            said = "; ".join(finding.text for finding in error.findings)
            return say("expected a URDF that can be used: {why}", why=said or str(error))
        return ""

    def starts(self, count: int, seed: int, nearest_m: float, farthest_m: float) -> list[Start]:
        """None: nothing comes into a robot's node that could be varied."""
        return []

    def interfaces_for(self, surely: Mapping[str, str], perhaps: Mapping[str, str]) -> str:
        """There is no choice."""
        return ""

    def adapted(self, text: str, ros_distro: str) -> str:
        """The same in all of them."""
        return text

    def how_to_try(self, program: str, package: str) -> str:
        """Beside robot_state_publisher."""
        return trying.how_to_try(program, package)

    def preload(self) -> None:
        """Import the node, if it can be: tf2_msgs may be missing."""
        with suppress(ImportError):
            from grader.scenes.robot import simulation  # noqa: F401

    def simulate(
        self, limits: Limits, start: Start | None, hooks: Hooks, interfaces: str, setting: str
    ) -> Simulation:
        """Make the node and the recorder; ROS is up."""
        from grader.scenes.robot.simulation import RobotSimulation

        return RobotSimulation(limits, hooks, setting)

    def untouched(self, start: Start | None) -> Trace:
        """Nothing."""
        return RobotTrace(0)

    def message_definitions(self) -> Mapping[str, str]:
        """Those of joint states, transforms and texts."""
        return decoding.DEFINITIONS

    def bag_topics(self, made: Trace) -> Iterable[tuple[str, str]]:
        """All four, also where nothing was heard."""
        return trace.TOPICS.items()

    def to_messages(self, made: Trace) -> list[Message]:
        """A trace as messages, by tick."""
        from grader.scenes.robot import messages

        return messages.to_messages(RobotTrace.of(made))

    def from_channels(self, channels: Sequence[Channel], ticks: int) -> Trace:
        """The trace of a bag's channels; see `grader.scenes.robot.messages`."""
        from grader.scenes.robot import messages

        return messages.from_channels(channels, ticks)

    def scenario(self, made: Trace) -> dict[str, Any]:
        """The joint states."""
        return behaviour.scenario(RobotTrace.of(made))

    def behaviour(self, made: Trace) -> Behaviour:
        """Joint states and the way in `odom`."""
        return behaviour.behaviour(RobotTrace.of(made))

    def endpoints(self, made: Trace, interfaces: str) -> Sequence[Endpoint]:
        """Those of its node."""
        return ENDPOINTS

    def pictures(self, made: Trace) -> Pictures:
        """The robot at the end, and its way from above."""
        run = RobotTrace.of(made)
        return Pictures(solid.window(run), {"plan": view.plan(run)})

    def view(self, made: Trace) -> View:
        """The robot, way, joints, heading, and tf."""
        return view.view(RobotTrace.of(made))

    def remarks(self, made: Trace, published: Sequence[str], interfaces: str) -> list[str]:
        """Nothing that a check does not say."""
        return []


SCENE: Scene = RobotScene()
