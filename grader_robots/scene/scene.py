"""A robot as a scene: its description, what robot_state_publisher sends of it, and tf."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import PurePath
from typing import Any, ClassVar, Final

import numpy as np

from grader.recording import BagMessage, Channel, Endpoint, Pictures, Start, Trace
from grader.scenes import Hooks, Introduction, Limits, Scene, Simulation, command_by_hand
from grader.scenes.view import View
from grader.text import NOTHING, Message, msg, tr
from grader_robots.robot_py.robot_state import RefusedDescription, Robot
from grader_robots.scene import driving, trace, view
from grader_robots.scene.trace import DESCRIPTION, JOINT_STATES, TF, TF_STATIC, TOPICS, RobotTrace

#: What the scene's node publishes and listens to, by name and type.
ENDPOINTS: Final = (
    *(Endpoint("subscription", topic, TOPICS[topic]) for topic in (JOINT_STATES, TF, TF_STATIC)),
    *(Endpoint("publisher", topic, TOPICS[topic]) for topic in (DESCRIPTION, TF, TF_STATIC)),
)


class RobotScene(Scene):
    """Its setting is the robot's description, a URDF."""

    name = "robot"
    introduction = Introduction(
        nodes=(("robot_state_publisher", "/"),),
        topics=(JOINT_STATES, TF, TF_STATIC),
        services=(),
        compares_stamps=True,
    )
    thing = msg("robot")
    outcomes: ClassVar = {"finished": msg("the robot was watched to the end")}
    plane = view.PLANE
    the_thing = msg("the robot")

    def wrong_setting(self, setting: str) -> Message:
        try:
            Robot.of(setting)
        except RefusedDescription as error:
            findings = "; ".join(finding.text for finding in error.findings)
            return msg("expected a URDF that can be used: {why}", why=findings or str(error))
        return NOTHING

    def how_to_try(self, program: str, package: str) -> str:
        run = tr(
            "From the folder above this one, in one terminal `robot_state_publisher` with the "
            "robot's description, in another your node:\n\n"
            "    ros2 run robot_state_publisher robot_state_publisher "
            '--ros-args -p robot_description:="$(cat FILE.urdf)"\n'
            "    {command}\n",
            command=command_by_hand(program, package),
        )
        with_package = tr(
            "The same from your package, in a workspace that has this folder in its `src`:\n\n"
            "    colcon build && . install/setup.bash\n"
            "    ros2 run {package} {name}\n",
            package=package,
            name=PurePath(program).stem,
        )
        see = tr(
            "To see the robot:\n\n"
            "- Every grading leaves `report.html`: the robot's way from above and its joints over "
            "time. It needs\n"
            "  nothing but a browser.\n"
            "- On a desktop with ROS 2, `rviz2`, with the Fixed Frame `odom` and a RobotModel "
            "display on the\n"
            "  topic `/robot_description`. A link that stays white and lies at the origin has no "
            "transform.\n"
            "- `ros2 topic echo /joint_states` and `ros2 run tf2_tools view_frames` show what your "
            "node sends.\n"
        )
        return "\n".join((run, with_package, see) if package else (run, see))

    def preload(self) -> None:
        """Import the node, if it can be: tf2_msgs may be missing."""
        with suppress(ImportError):
            from grader_robots.scene import simulation  # noqa: F401

    def simulate(
        self, limits: Limits, start: Start | None, hooks: Hooks, interfaces: str, setting: str
    ) -> Simulation:
        """Make the node and the recorder; ROS is up."""
        from grader_robots.scene.simulation import RobotSimulation

        return RobotSimulation(limits, hooks, setting)

    def untouched(self, start: Start | None) -> Trace:
        return RobotTrace(0)

    def bag_topics(self, made: Trace) -> Iterable[tuple[str, str]]:
        """All four, also where nothing was heard."""
        return TOPICS.items()

    def to_messages(self, made: Trace) -> list[BagMessage]:
        """A trace as messages, by time."""
        return trace.to_messages(RobotTrace.of(made))

    def from_channels(self, channels: Sequence[Channel], duration_ns: int) -> Trace:
        """The trace of a bag's channels."""
        return trace.from_channels(channels, duration_ns // trace.TICK_NS)

    def scenario(self, made: Trace) -> dict[str, Any]:
        """The joint states that were heard: what is not a number is None."""
        run = RobotTrace.of(made)
        return {
            "ticks": run.ticks,
            "joint_states": [
                {
                    "tick": state.tick,
                    "stamp_ns": state.stamp_ns,
                    "name": list(state.names),
                    "position": [p if np.isfinite(p) else None for p in state.positions],
                }
                for state in run.joint_states
                if 1 <= state.tick <= run.ticks
            ],
        }

    def endpoints(self, made: Trace, interfaces: str) -> Sequence[Endpoint]:
        return ENDPOINTS

    def pictures(self, made: Trace) -> Pictures:
        return Pictures(view.plan(RobotTrace.of(made)))

    def view(self, made: Trace) -> View:
        """The robot, way, joints, heading, and tf."""
        return view.view(RobotTrace.of(made))

    def odd_traces(self, setting: str, start: Start | None) -> Mapping[str, Trace]:
        return driving.odd_traces(setting)


SCENE: Final = RobotScene()
