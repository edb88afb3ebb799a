"""The behaviour of robot_state_publisher 3.3.4, Jazzy's, without a node.

`Robot.of` reads a description, `RobotState` answers each joint state that is heard: what goes to
/tf, and what is logged. Nothing here knows a clock or a topic: all times are arguments, in
nanoseconds, so a grader can ask afterwards what the node would have done.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from grader_robots.robot_py import kinematics
from grader_robots.robot_py.kinematics import LinkTree
from grader_robots.robot_py.model import Joint, Model, Vector
from grader_robots.robot_py.tinyxml import UrdfFinding
from grader_robots.robot_py.urdf import parse

NS_PER_MS = 1_000_000

EMPTY = "Empty URDF is not allowed"
UNUSABLE = "Unable to initialize urdf::model from robot description"
NO_TREE = "Failed to extract kdl tree from robot description"
#: What is refused at start and at run time has other words.
FREQUENCY_AT_START = "publish_frequency must be between 0 and 1000"
FREQUENCY = "publish_frequency must be between 0.0 and 1000.0"
MISSING = "robot_description parameter must not be empty"
FROM_FILE = (
    "No robot_description parameter, but command-line argument available.  Assuming argument is "
    "name of URDF file.  This backwards compatibility fallback will be removed in the future."
)
UNREADABLE = "Failed to open URDF file: {}"
INITIALIZED = "Robot initialized"
NO_POSITIONS = (
    'Robot state publisher ignored a JointState message about joint(s) "{}"(,...) whose position '
    "member was empty."
)
INVALID = "Robot state publisher ignored an invalid JointState message"
BACKWARDS = "Moved backwards in time, re-publishing joint transforms!"
NEGATIVE = "cannot store a negative time point in rclcpp::Time"
ROOT_INERTIA = (
    "The root link {} has an inertia specified in the URDF, but KDL does not support a root link "
    "with an inertia.  As a workaround, you can add an extra dummy link to your URDF."
)
UNKNOWN_TYPE = "Converting unknown joint type of joint '{}' into a fixed joint"


@dataclass(frozen=True, slots=True)
class NodeLog:
    """A line that a node would log.

    Attributes:
        logger: its logger's name; '' for the node's.
    """

    severity: Literal["WARN", "ERROR"]
    text: str
    logger: str = ""


class RefusedDescription(ValueError):
    """A description that robot_state_publisher refuses, at its start or later.

    Attributes:
        findings: what urdfdom prints of it.
    """

    def __init__(self, reason: str, findings: tuple[UrdfFinding, ...] = ()) -> None:
        super().__init__(reason)
        self.findings = findings


@dataclass(frozen=True, slots=True)
class Parameters:
    """The node's parameters beside the description; each change acts at the next joint state."""

    publish_frequency: float = 20.0
    frame_prefix: str = ""
    ignore_timestamp: bool = False

    @property
    def interval_ns(self) -> int:
        """How far the stamps of two messages are apart at least: whole milliseconds.

        A frequency of 0 is allowed and means none: that is what the conversion, which C++ leaves
        open, gives with gcc on x86-64.
        """
        hertz = self.publish_frequency
        return int(1000.0 / hertz) * NS_PER_MS if hertz > 0 else 0


def is_usable_frequency(hertz: float) -> bool:
    """Whether robot_state_publisher accepts it as publish_frequency."""
    return not (hertz < 0.0 or hertz > 1000.0)


@dataclass(frozen=True, slots=True)
class Placed:
    """A frame in another: a TransformStamped."""

    stamp_ns: int
    frame: str
    child_frame: str
    translation: Vector
    rotation: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class JointState:
    """The fields of a JointState message that are used."""

    stamp_ns: int
    names: Sequence[str]
    positions: Sequence[float]


@dataclass(frozen=True, slots=True)
class Published:
    """The messages and log lines on a joint state.

    Attributes:
        transforms: the message on /tf; None where there is none. It may be empty: then the joint
            state named no joint of the robot that moves.
    """

    transforms: tuple[Placed, ...] | None
    logs: tuple[NodeLog, ...] = ()


@dataclass(frozen=True, slots=True)
class Robot:
    """An accepted description, and urdfdom's findings on it."""

    description: str
    model: Model
    tree: LinkTree
    findings: tuple[UrdfFinding, ...]

    @classmethod
    def of(cls, description: str) -> Robot:
        """Read a description.

        Raises:
            RefusedDescription: robot_state_publisher refuses it. A circle of links, which it does
                not survive, is refused here.
        """
        reading = parse(description)
        if reading.model is None:
            raise RefusedDescription(UNUSABLE, reading.findings)
        tree = kinematics.tree(reading.model)
        if tree.is_endless:
            raise RefusedDescription(NO_TREE, reading.findings)
        return cls(description, reading.model, tree, reading.findings)

    @property
    def logs(self) -> tuple[NodeLog, ...]:
        """The log lines of kdl_parser."""
        texts = []
        if self.model.links[self.model.root].inertial is not None:
            texts.append(ROOT_INERTIA.format(self.model.root))
        for joint in self.tree.joints.values():
            if joint.type in ("planar", "floating"):
                texts.append(UNKNOWN_TYPE.format(joint.name))
        return tuple(NodeLog("WARN", text, "kdl_parser") for text in texts)

    def fixed(self, prefix: str, now_ns: int) -> tuple[Placed, ...]:
        """Return the transforms for /tf_static, by the alphabet of their joints' names."""
        joints = self.tree.fixed.values()
        return tuple(placed(joint, 0.0, now_ns, prefix) for joint in joints)


def placed(joint: Joint, position: float, stamp_ns: int, prefix: str) -> Placed:
    """Return where a joint's child is in its parent."""
    transform = kinematics.joint_transform(joint, position)
    return Placed(
        stamp_ns,
        prefix + joint.parent,
        prefix + joint.child,
        kinematics.translation(transform),
        kinematics.quaternion(transform),
    )


class RobotState:
    """Answers joint states; remembers when each joint was published.

    Attributes:
        parameters: may be replaced at any time.
        robot: whose frames are published; `set_robot` replaces it.
    """

    def __init__(self, robot: Robot, parameters: Parameters | None = None) -> None:
        self.parameters = parameters or Parameters()
        self._published_ns: dict[str, int] = {}
        self._heard_ns = 0
        self.set_robot(robot)

    def set_robot(self, robot: Robot) -> None:
        """Publish another robot's frames from now on; stamps are remembered."""
        self.robot = robot
        self._moving = robot.tree.moving

    def hear(self, state: JointState, now_ns: int) -> Published:
        """Return what is published when a joint state arrives now."""
        if len(state.names) != len(state.positions):
            if len(state.positions):
                return Published(None, (NodeLog("ERROR", INVALID),))
            return Published(None, (NodeLog("WARN", NO_POSITIONS.format(state.names[0])),))
        if state.stamp_ns < 0:
            # the original ends here, by an uncaught exception
            return Published(None, (NodeLog("ERROR", NEGATIVE),))
        logs: tuple[NodeLog, ...] = ()
        if self._heard_ns > now_ns:
            logs = (NodeLog("WARN", BACKWARDS),)
            self._published_ns.clear()
        self._heard_ns = now_ns
        if not self._is_due(state, now_ns):
            return Published(None, logs)
        self._published_ns.update(dict.fromkeys(state.names, state.stamp_ns))
        return Published(self._transforms(state), logs)

    def _is_due(self, state: JointState, now_ns: int) -> bool:
        """Whether enough time has passed since all of its joints were published, by the stamps.

        Never for a stamp of 0, and always where now is 0, i.e. not known.
        """
        last_ns = min([now_ns, *(self._published_ns.get(name, 0) for name in state.names)])
        due_ns = last_ns + self.parameters.interval_ns
        return self.parameters.ignore_timestamp or state.stamp_ns >= due_ns

    def _transforms(self, state: JointState) -> tuple[Placed, ...]:
        positions: dict[str, float] = {}
        for name, position in zip(state.names, state.positions, strict=True):
            positions.setdefault(name, position)
        positions = kinematics.with_mimics(self.robot.model, positions)
        prefix = self.parameters.frame_prefix
        return tuple(
            placed(self._moving[name], positions[name], state.stamp_ns, prefix)
            for name in sorted(positions)
            if name in self._moving
        )
