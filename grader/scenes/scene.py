"""What a scene is: whatever runs beside a submission, and everything that only it can know.

A scene has nodes, a tick, a place where things start, something that it records, and a rule for
when a run is over. Runs in real and in virtual time, recordings and reports know it by `Scene`
alone. What it does in the simulator's process is its `Simulation`; the rest needs no ROS.
A scene knows nothing of exercises, submissions and results.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, Protocol

from grader.scenes.channel import Channel
from grader.scenes.view import Floats, Pictures, Plane, View

#: Why a run is over: it came to rest, all that there is to see was seen, nothing ever moved, the
#: submission is gone, time is up.
Reason = Literal["", "rest", "seen", "no_motion", "gone", "time_limit"]


@dataclass(frozen=True)
class Start:
    """Where what is driven stands when a run begins: x, y [m], theta [rad]."""

    x: float
    y: float
    theta: float


class Trace(Protocol):
    """What a scene has recorded of a run; each scene has a type of its own for it."""

    @property
    def ticks(self) -> int:
        """How many ticks were recorded."""

    @property
    def simulated_s(self) -> float:
        """How long that was [s]."""

    def sha256(self) -> str:
        """A hash of all that moved and all that came in; equal hashes mean equal runs."""


@dataclass(frozen=True)
class Limits:
    """When a run ends, in simulated seconds.

    Attributes:
        first_motion_s: nothing has moved by then.
        rest_s: something has driven and then rested for so long; who has not yet left the place
            may pause for as long as `first_motion_s`.
        total_s: in any case.
    """

    first_motion_s: float
    rest_s: float
    total_s: float


@dataclass(frozen=True)
class Introduction:
    """What of a scene a submission's process has to know before it can talk with it.

    Attributes:
        nodes: the names and namespaces of the scene's nodes.
        topics, services: names that a submission drives the scene by, and that are there from the
            start. In real time its publishers and clients of these wait until they are connected;
            those of names that end like them, for a while.
        compares_stamps: whether it matters that two stamps are one. In virtual time a callback
            takes no time; a node's clock then tells those apart for which it was asked twice.
    """

    nodes: tuple[tuple[str, str], ...]
    topics: tuple[str, ...]
    services: tuple[str, ...]
    compares_stamps: bool = False


EndpointKind = Literal["publisher", "subscription", "service", "action"]


class Endpoint(NamedTuple):
    """What a scene's node has itself: an end of a topic, or the server of a service or action.

    Attributes:
        name: with its namespace.
        type: as 'geometry_msgs/msg/Twist'.
    """

    kind: EndpointKind
    name: str
    type: str


@dataclass(frozen=True)
class Hooks:
    """How a run takes part in a simulation.

    Attributes:
        has_unread: whether anything has arrived; while nothing has, a node need not be served.
        tell: gets what somebody who looks on is to see, as plain data that its scene's live page
            (`grader.scenes.live`) takes, after each tick; None where nobody does.
    """

    has_unread: Callable[[], bool] = lambda: True
    tell: Callable[[Mapping[str, Any]], None] | None = None


@dataclass(frozen=True)
class Forecast:
    """What will be published in the next ticks if nothing arrives.

    Attributes:
        publishers: rclpy's, each of which publishes once in each of these ticks.
        ticks: for each, what they publish, in their order, in CDR.
    """

    publishers: tuple[Any, ...]
    ticks: list[tuple[bytes, ...]]


class Command(NamedTuple):
    """Something that a submission asked of a scene.

    Attributes:
        tick: when.
        name: what; of one that asks the same of something else it is another.
        values: how, in the scene's own order and units; may be not a number.
    """

    tick: int
    name: str
    values: tuple[float, ...]


@dataclass(frozen=True)
class Behaviour:
    """What a submission did, as far as another could do just the same.

    Attributes:
        commands: what it asked for, in order; of each what has an effect, and no names of its own.
        path: where what the exercise is about went, float64 (n, 2) [m]; all of it finite.
    """

    commands: tuple[Command, ...]
    path: Floats


class Simulation(Protocol):
    """A scene at work, in the simulator's process, when ROS is up there."""

    @property
    def node(self) -> Any:
        """A node of it, to ask what others publish: an `rclpy.node.Node`."""

    @property
    def is_at_rest(self) -> bool:
        """Whether what is driven has moved, and does not now."""

    @property
    def flags(self) -> tuple[str, ...]:
        """Remarks for the result: what the submission asked for and did not get."""

    def record(self) -> None:
        """Record from the next tick on; inputs are recorded from the beginning."""

    def submission_gone(self) -> None:
        """The submission's process has ended."""

    def follow_wall_clock(self, step: Callable[[], bool]) -> None:
        """Call `step` at the rate of the scene's ticks, until it returns False."""

    def tick(self, now_ns: int | None = None) -> Reason:
        """Serve what has arrived, let a tick pass; why the run is over, or ''.

        Args:
            now_ns: the time on the clock of the run [ns], where somebody knows; else a node's
                clock is asked.
        """

    def foresee(self, most: int) -> Forecast:
        """The next ticks, so many at most: as far as they are certain if nothing arrives.

        None where the run might end, a node is to be served, or something other than publishing
        would happen.
        """

    def pass_tick(self, now_ns: int) -> tuple[Reason, tuple[bytes, ...]]:
        """As `tick`, in a tick that was foreseen: publishes nothing, returns what it would have."""

    @property
    def recorded_s(self) -> float:
        """How long it has recorded [simulated s]."""

    def trace(self) -> Trace:
        """Everything recorded up to now."""


class Message(NamedTuple):
    """A message of a bag: its tick, topic, ROS type, and its CDR."""

    tick: int
    topic: str
    msgtype: str
    data: bytes


class Scene(Protocol):
    """A kind of scene; all of it but `simulate` works without ROS."""

    @property
    def name(self) -> str:
        """As an exercise names it; also that of its folder."""

    @property
    def examiner(self) -> str:
        """The program, in this repository, that looks at a submission of which nothing is started.

        '' in a scene that has nodes. Where there is one, a run has no clock and no simulator:
        the program is the submission's process, and leaves what `decode` takes.
        """

    @property
    def tick_ns(self) -> int:
        """The length of a tick [ns]."""

    @property
    def introduction(self) -> Introduction:
        """What a submission's process has to know of it."""

    @property
    def thing(self) -> str:
        """What a submission drives, in a word."""

    @property
    def finished(self) -> str:
        """What has happened in a run that is finished, as a clause: 'the robot came to rest'."""

    @property
    def the_thing(self) -> str:
        """What a submission drives, as in a sentence: 'the robot'."""

    @property
    def plane(self) -> Plane:
        """How places become pixels."""

    @property
    def window_is_plane(self) -> bool:
        """Whether what a person would have seen is that plane, so that places can be shown in it.

        Else its `pictures` have a `plan`, if anything moves.
        """

    @property
    def farthest_start_m(self) -> float:
        """So far from the usual place something can start and still has room on every side."""

    def wrong_setting(self, setting: str) -> str:
        """Why a run cannot be set up with what an exercise gives; '' where it can.

        Args:
            setting: the text of a file of the exercise's, as a robot's description; '' for none.
        """

    def starts(self, count: int, seed: int, nearest_m: float, farthest_m: float) -> list[Start]:
        """Where varied runs start, so far from the usual place; the same for the same seed."""

    def interfaces_for(self, surely: Mapping[str, str], perhaps: Mapping[str, str]) -> str:
        """Which of its interfaces a submission was written for; '' in a scene that has no choice.

        Args:
            surely, perhaps: the modules that the submission imports whenever it is run, and those
                that it may import, each with the place of the first import, in the order of these.

        Raises:
            SubmissionError: it cannot have been written for any.
        """

    def adapted(self, text: str, ros_distro: str) -> str:
        """A Python file or a package.xml as a ROS 2 release needs it; named as in ROS_DISTRO."""

    def how_to_try(self, program: str, package: str) -> str:
        """How a student runs a node beside it by hand and sees what happens, in Markdown.

        Args:
            program: the node's Python file.
            package: the ROS package that it is in; '' for none.
        """

    # In the simulator's process ---------------------------------------------------------------

    def preload(self) -> None:
        """Import and make what is the same in every simulation; nothing of ROS is up."""

    def simulate(
        self, limits: Limits, start: Start | None, hooks: Hooks, interfaces: str, setting: str
    ) -> Simulation:
        """Make the nodes and everything else; ROS is up.

        Args:
            interfaces: from `interfaces_for`; '' for the usual ones.
            setting: what the exercise sets it up with; see `wrong_setting`.
        """

    def untouched(self, start: Start | None) -> Trace:
        """What a run leaves in which nothing could be recorded, not even the time."""

    # Recordings -------------------------------------------------------------------------------

    def message_definitions(self) -> Mapping[str, str]:
        """The definitions of the ROS types in its bags, and of the types of their fields."""

    def bag_topics(self, trace: Trace) -> Iterable[tuple[str, str]]:
        """Topics with their types that a bag has even where it holds no message of them."""

    def to_messages(self, trace: Trace) -> list[Message]:
        """A trace as messages, by tick."""

    def from_channels(self, channels: Sequence[Channel], ticks: int) -> Trace:
        """The trace of a bag's channels, each with a topic of its own, in the bag's order.

        Args:
            ticks: how many were recorded.

        Raises:
            ValueError, KeyError, TypeError: they are not from `to_messages`.
        """

    def scenario(self, trace: Trace) -> dict[str, Any]:
        """The inputs, to be replayed without ROS."""

    def behaviour(self, trace: Trace) -> Behaviour:
        """What the submission did, for whoever compares submissions; see `grader.batch.similar`."""

    # Diagnosis and reports --------------------------------------------------------------------

    def endpoints(self, trace: Trace, interfaces: str) -> Sequence[Endpoint]:
        """What of the scene a submission could have met in a run; the usual ones first.

        Args:
            interfaces: with which the scene was run.
        """

    def pictures(self, trace: Trace) -> Pictures:
        """What it looked like at the end."""

    def view(self, trace: Trace) -> View:
        """The trace for a page."""

    def remarks(self, trace: Trace, published: Sequence[str], interfaces: str) -> list[str]:
        """What a reader of any exercise's result should know about the run.

        Args:
            published: the topics that the submission published on.
            interfaces: with which the scene was run.
        """
