"""What a recording is of: a scene that ran beside a submission, or a package that was examined.

A `Subject` knows how its traces are kept in a bag and read back, and how they are shown. Nothing
here needs ROS, and whoever reads a recording knows it by this alone.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Final, Literal, NamedTuple, Protocol

import numpy as np

from grader import extensions
from grader.message import NOTHING, Message, msg
from grader.recording.channel import Channel
from grader.recording.view import Floats, Pictures, Plane, View

if TYPE_CHECKING:
    from grader.recording.playback import Playback


#: What runs beside a submission where nothing else is said.
DEFAULT_SCENE: Final = "turtlesim"
#: The subject of what is found by looking at a package; a run's recording may hold such a trace.
PACKAGE_SCENE: Final = "package"


@dataclass(frozen=True)
class Start:
    """Where what is driven stands when a run begins: x, y [m], theta [rad]."""

    x: float
    y: float
    theta: float


class Trace(Protocol):
    """What was recorded of a run; each subject has a type of its own for it."""

    @property
    def duration_ns(self) -> int:
        """How long was recorded [simulated ns]."""

    @property
    def ticks(self) -> int:
        """How many of its own steps that was; 0 for what counts none."""

    def sha256(self) -> str:
        """A hash of all that moved and all that came in; equal hashes mean equal runs."""


class BagMessage(NamedTuple):
    """A message of a bag: when [ns from the start of the run], topic, ROS type, and its CDR."""

    time_ns: int
    topic: str
    msgtype: str
    data: bytes


EndpointKind = Literal["publisher", "subscription", "service", "action"]


class Endpoint(NamedTuple):
    """What a scene's node has: an end of a topic, or the server of a service or action.

    Attributes:
        name: with its namespace.
        type: as 'geometry_msgs/msg/Twist'.
    """

    kind: EndpointKind
    name: str
    type: str


class Command(NamedTuple):
    """Something that a submission asked for.

    Attributes:
        time_ns: when, from the start of the run [ns].
        name: what; of one that asks the same of something else it is another.
        values: how, in the subject's own order and units; may be not a number.
    """

    time_ns: int
    name: str
    values: tuple[float, ...]


@dataclass(frozen=True)
class Behaviour:
    """What a submission did, as far as another could do just the same.

    Attributes:
        commands: what it asked for, in order; of each what has an effect, and no names of its own.
        path: where what the exercise is about went, float64 (n, 2) [m]; all of it finite.
    """

    commands: tuple[Command, ...] = ()
    path: Floats = field(default_factory=lambda: np.empty((0, 2)))


def until_lost(points: Floats) -> Floats:
    """Of places, float64 (n, 2), those before the first that is not a number."""
    lost = np.flatnonzero(~np.isfinite(points).all(axis=1))
    return points[: int(lost[0])] if len(lost) else points


class Subject(ABC):
    """What recordings are of. The abstract members are obligatory, the others have defaults."""

    #: As an exercise names it, and under which it is registered (`grader.scenes`).
    name: ClassVar[str]
    #: What a submission drives, or what is examined, as in a sentence: 'the turtle'.
    the_thing: ClassVar[Message]
    #: The same without an article.
    thing: ClassVar[Message]
    #: How a run ended -> that as a clause, 'the turtle came to rest', where it is not as for any
    #: node. The keys are those of `grader.reports.wording.OUTCOMES`.
    outcomes: ClassVar[Mapping[str, Message]] = {}
    #: How places become pixels.
    plane: ClassVar[Plane] = Plane(500, 1.0, 500.0)
    #: Whether what a person would have seen is that plane, so that places can be shown in it. Else
    #: its `pictures` have a `plan`, if anything moves.
    window_is_plane: ClassVar[bool] = False

    # What is kept in a bag, and read back ---------------------------------------------------------

    @abstractmethod
    def untouched(self, start: Start | None) -> Trace:
        """The trace of a run in which nothing could be recorded, not even the time."""

    @abstractmethod
    def message_definitions(self) -> Mapping[str, str]:
        """The definitions of the ROS types in its bags, and of the types of their fields."""

    @abstractmethod
    def to_messages(self, trace: Trace) -> list[BagMessage]:
        """A trace as messages, by time."""

    @abstractmethod
    def from_channels(self, channels: Sequence[Channel], duration_ns: int) -> Trace:
        """The trace of a bag's channels, each with a topic of its own, in the bag's order.

        Args:
            duration_ns: how long was recorded.

        Raises:
            ValueError, KeyError, TypeError: they are not from `to_messages`.
        """

    def encode(self, trace: Trace) -> bytes:
        """A trace as JSON, for a file beside the bag of another; the subject `package` alone can.

        The same trace gives the same bytes.
        """
        raise NotImplementedError

    def decode(self, data: bytes) -> Trace:
        """The trace that `encode` made bytes of.

        Raises:
            ValueError: they mean none.
        """
        raise NotImplementedError

    def bag_topics(self, trace: Trace) -> Iterable[tuple[str, str]]:
        """Topics with their types that a bag has even where it holds no message of them."""
        return ()

    def scenario(self, trace: Trace) -> dict[str, Any]:
        """The inputs, to be replayed without ROS; empty where they cannot be."""
        return {}

    def behaviour(self, trace: Trace) -> Behaviour:
        """What the submission did, for whoever compares submissions."""
        return Behaviour()

    # How it is shown ------------------------------------------------------------------------------

    def view(self, trace: Trace) -> View:
        """The trace for a page."""
        return View()

    def pictures(self, trace: Trace) -> Pictures:
        """What it looked like at the end."""
        return Pictures()

    def remarks(self, trace: Trace, published: Sequence[str], interfaces: str) -> list[Message]:
        """What a reader of any exercise's result should know about the run.

        Args:
            published: the topics that the submission published on.
            interfaces: with which the scene was run.
        """
        return []

    def endpoints(self, trace: Trace, interfaces: str) -> Sequence[Endpoint]:
        """What a submission could have met in a run; the usual ones first.

        Args:
            interfaces: with which the scene was run.
        """
        return ()

    @property
    def player(self) -> Callable[[Playback], str] | None:
        """What makes a page that plays runs, HTML that needs nothing beside it; None: nothing.

        It raises RecordingError where a run cannot be played.
        """
        return None

    # What an exercise says about it ---------------------------------------------------------------

    def wrong_setting(self, setting: str) -> Message:
        """Why it cannot be set up with what an exercise gives; NOTHING where it can.

        Args:
            setting: the text of a file of the exercise's, as a robot's description; '' for none.
        """
        return msg("{scene} takes none", scene=self.name) if setting else NOTHING

    def adapted(self, text: str, ros_distro: str) -> str:
        """A Python file or a package.xml as a ROS 2 release needs it; named as in ROS_DISTRO."""
        return text

    def how_to_try(self, program: str, package: str) -> str:
        """How a student tries a solution by hand, in Markdown; '' where nothing is to be said.

        Args:
            program: the node's Python file.
            package: the ROS package that it is in; '' for none.
        """
        return ""

    def odd_traces(self, setting: str, start: Start | None) -> Mapping[str, Trace]:
        """Traces that checks have to survive, by what the submission did: 'a node that jumps'.

        Args:
            setting: of the exercise whose checks are tried.
            start: where the runs begin.
        """
        return {}


def load_subject(name: str) -> Subject:
    """What an exercise names as its `scene:`.

    Raises:
        KeyError: nothing of this name is installed.
    """
    subject: Subject = extensions.load(extensions.SCENES, name)
    return subject
