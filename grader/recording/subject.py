"""The subject of a recording: a scene that ran beside a submission, or an inspected package.

A `Subject` knows how its traces are kept in a bag and read back, and how they are shown. Nothing
here needs ROS, and readers of recordings know no more of a scene.
"""

from __future__ import annotations

import signal
import traceback
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import wraps
from pathlib import Path
from typing import Any, ClassVar, Final, Literal, NamedTuple, Protocol

from grader.errors import SceneFailure, SubmissionError, UsageError
from grader.recording.mcap import Channel
from grader.recording.view import Pictures, Plane, View
from grader.system import extensions
from grader.system.strict_json import SPARSE
from grader.text.message import NOTHING, Message, msg
from grader.text.strings import place, shown

#: The scene of an exercise that names none.
DEFAULT_SCENE: Final = "turtlesim"
#: Hooks of a subject, and of a scene, and what they may raise; `from_channels` may raise
#: anything.
HOOKS: Final[Mapping[str, tuple[type[Exception], ...]]] = {
    **dict.fromkeys(("untouched", "definitions_of", "to_messages"), ()),
    **dict.fromkeys(("bag_topics", "scenario", "view", "pictures"), ()),
    **dict.fromkeys(("remarks", "endpoints", "wrong_setting", "adapted", "how_to_try"), ()),
    **dict.fromkeys(("odd_traces", "simulate", "preload", "starts"), ()),
    **{"interfaces_for": (SubmissionError,), "live_page": (OSError,)},
}
#: The subject of a package inspection; a run's recording may hold such a trace.
PACKAGE_SCENE: Final = "package"
#: The scene whose traces are those of a cast, also of one beside another scene.
CAST_SCENE: Final = "graph"
#: What stands in for rclpy's middleware in virtual time.
STAND_IN: Final = Path(__file__).parents[1] / "run" / "lockstep"
#: So much of what a scene raises or returns is shown [characters].
LONGEST_WORDS: Final = 300


@dataclass(frozen=True)
class Start:
    """How a varied run begins.

    Attributes:
        x, y, theta: the pose of the turtle or robot [m, m, rad].
        speed, turn: in all of the run it drives so many times as fast as it is commanded, and turns
            so many times as fast. Only a program that reads the pose notices.
    """

    x: float
    y: float
    theta: float
    speed: float = field(default=1.0, metadata=SPARSE)
    turn: float = field(default=1.0, metadata=SPARSE)

    @property
    def is_as_commanded(self) -> bool:
        return self.speed == self.turn == 1.0

    @property
    def words(self) -> Message:
        """'from (5.54, 7.20)', and its factors, if there are some."""
        if self.is_as_commanded:
            return msg("from {place}", place=place(self.x, self.y))
        return msg(
            "from {place}, driving {speed:g} times as fast and turning {turn:g} times as fast as "
            "commanded",
            place=place(self.x, self.y),
            speed=self.speed,
            turn=self.turn,
        )


class Trace(Protocol):
    """The recorded data of a run; each subject has a type of its own for it."""

    @property
    def duration_ns(self) -> int:
        """The length of the recording [simulated ns]."""

    @property
    def ticks(self) -> int:
        """The number of ticks; 0 for a subject without ticks."""

    def sha256(self) -> str:
        """A hash of all motion and all inputs; equal hashes mean equal runs."""


class BagMessage(NamedTuple):
    """A message of a bag: when [ns from the start of the run], topic, ROS type, and its CDR."""

    time_ns: int
    topic: str
    msgtype: str
    data: bytes


EndpointKind = Literal["publisher", "subscription", "service", "action"]


class Endpoint(NamedTuple):
    """An endpoint of a scene's node: of a topic, or the server of a service or action.

    Attributes:
        name: with its namespace.
        type: as 'geometry_msgs/msg/Twist'.
        node: of a scripted peer; '' for the scene itself.
        begin_s: from when on it is there [s].
    """

    kind: EndpointKind
    name: str
    type: str
    node: str = ""
    begin_s: float = 0.0


RoleKind = Literal[
    "publisher", "subscription", "service", "client", "action", "action_client", "parameter"
]


class Role(NamedTuple):
    """What a program has on the graph: an end of a topic, service or action, or a parameter.

    Attributes:
        name: with its namespace; of a parameter its own.
    """

    kind: RoleKind
    name: str


# Mistakes of a scene, told from those of a submission and of ours ---------------------------------


class Overdue(BaseException):
    """A scene has not returned in time; no `except Exception` of its own catches it."""


def overdue(*_: object) -> None:
    """Handle the alarm of `scene_at_work`."""
    raise Overdue("it did not return")


@contextmanager
def scene_at_work(scene: str, *may_raise: type[Exception], within_s: float = 0.0) -> Iterator[None]:
    """Raise a `SceneFailure` for an exception of a scene's own code, but for what it may raise.

    Also where that takes longer than `within_s` [s], where `overdue` handles SIGALRM; 0: no limit.
    A lack of memory, and what rclpy or its stand-in raises, may be the submission's doing or ours.
    """
    passed: tuple[type[Exception], ...] = (SceneFailure, *may_raise)  # one hook calls another
    try:
        if within_s:
            signal.setitimer(signal.ITIMER_REAL, within_s, within_s)
        yield
    except passed:
        raise
    except (Exception, SystemExit, Overdue) as error:
        is_overdue = isinstance(error, Overdue)  # then the last place is the alarm's handler
        place = traceback.extract_tb(error.__traceback__)[-1 - is_overdue]
        is_of_rclpy = type(error).__module__.startswith("rclpy._")
        is_stand_in = STAND_IN in Path(place.filename).parents and not is_overdue
        if is_of_rclpy or is_stand_in or isinstance(error, MemoryError):
            raise
        where = {"file": Path(place.filename).name, "line": str(place.lineno)}
        what = shown(f"{type(error).__name__}: {error}", LONGEST_WORDS)
        raised = msg(
            "the scene {scene} raised {what} ({file}, line {line})", scene=scene, what=what, **where
        )
        raise SceneFailure(raised) from error
    finally:
        if within_s:
            signal.setitimer(signal.ITIMER_REAL, 0)


def at_work(hook: Callable[..., Any], *may_raise: type[Exception]) -> Callable[..., Any]:
    """Return a hook of a subject that raises a `SceneFailure` for all but what it may raise."""

    @wraps(hook)
    def named(self: Any, *args: Any, **words: Any) -> Any:
        with scene_at_work(self.name, *may_raise):
            return hook(self, *args, **words)

    return named


class Subject(ABC):
    """The subject of recordings. The abstract members are obligatory, the others have defaults."""

    #: In an exercise, and of its entry point (`grader.scenes`).
    name: ClassVar[str]
    #: What a submission drives, or what is inspected, with its article: 'the turtle'.
    the_thing: ClassVar[Message]
    #: The same without an article.
    thing: ClassVar[Message]
    #: How a run ended -> that as a clause, 'the turtle came to rest', where it is not as for any
    #: node. The keys are those of `grader.reports.wording.OUTCOMES`.
    outcomes: ClassVar[Mapping[str, Message]] = {}
    #: How places become pixels.
    plane: ClassVar[Plane] = Plane(500, 1.0, 500.0)
    #: Whether its trace is that of scripted peers; else that is kept beside its own.
    has_cast: ClassVar[bool] = False

    def __init_subclass__(cls, **words: Any) -> None:
        """Let exceptions of its hooks name the subject, the file and the line."""
        super().__init_subclass__(**words)
        for name in HOOKS.keys() & vars(cls).keys():
            setattr(cls, name, at_work(vars(cls)[name], *HOOKS[name]))

    # What is kept in a bag, and read back ---------------------------------------------------------

    @abstractmethod
    def untouched(self, start: Start | None) -> Trace:
        """The trace of a run in which nothing could be recorded, not even the time."""

    def definitions_of(self, trace: Trace) -> Mapping[str, str]:
        """The definitions of the ROS types in its bag, and of the types of their fields.

        Those of `grader.ros.bag_types` need none.
        """
        return {}

    @abstractmethod
    def to_messages(self, trace: Trace) -> list[BagMessage]:
        """A trace as messages, by time."""

    @abstractmethod
    def from_channels(self, channels: Sequence[Channel], duration_ns: int) -> Trace:
        """Read a trace from a bag's channels, each with a topic of its own, in the bag's order.

        Args:
            duration_ns: how long was recorded.

        Raises:
            ValueError, KeyError, TypeError: they are not from `to_messages`.
        """

    def bag_topics(self, trace: Trace) -> Iterable[tuple[str, str]]:
        """Return the topics, with types, that a bag has even without a message of them."""
        return ()

    def scenario(self, trace: Trace) -> dict[str, Any]:
        """Return the inputs, to be replayed without ROS; empty where they cannot be."""
        return {}

    # How it is shown ------------------------------------------------------------------------------

    def view(self, trace: Trace) -> View:
        """Return the trace as a page shows it."""
        return View()

    def pictures(self, trace: Trace) -> Pictures:
        """Draw the scene at the end."""
        return Pictures()

    def remarks(self, trace: Trace, published: Sequence[str], interfaces: str) -> list[Message]:
        """Return what a reader of any exercise's result should know about the run.

        Args:
            published: the topics that the submission published on.
            interfaces: with which the scene was run.
        """
        return []

    def endpoints(self, trace: Trace, interfaces: str) -> Sequence[Endpoint]:
        """Return the endpoints that a submission could have met in a run; the usual ones first.

        Args:
            interfaces: with which the scene was run.
        """
        return ()

    @property
    def player(self) -> Callable[[Any], str] | None:
        """Renders a page that plays runs, HTML that needs no other file; None: there is none.

        It is called with a `grader.scenes.playback.Playback`, and raises RecordingError where a
        run cannot be played.
        """
        return None

    # What an exercise sets about it ---------------------------------------------------------------

    def wrong_setting(self, setting: str) -> Message:
        """Say why a scene cannot be set up with an exercise's setting; NOTHING where it can.

        Args:
            setting: the text of a file of the exercise's, as a robot's description; '' for none.
        """
        return msg("{scene} takes none", scene=self.name) if setting else NOTHING

    def adapted(self, text: str, ros_distro: str) -> str:
        """Adapt a Python file or a package.xml to a ROS 2 release, named as in ROS_DISTRO."""
        return text

    def how_to_try(self, program: str, package: str) -> str:
        """Describe how a student tries a solution by hand, in Markdown; '' for nothing.

        Args:
            program: the node's Python file, as the folder above that of the submission finds it.
            package: the ROS package that it is in; '' for none.
        """
        return ""

    def odd_traces(self, setting: str, start: Start | None) -> Mapping[str, Trace]:
        """Return traces that checks have to survive, by their descriptions: 'a node that jumps'.

        Args:
            setting: of the exercise whose checks are tried.
            start: where the runs begin.
        """
        return {}


def load_subject(name: str) -> Subject:
    """Load the subject that an exercise names as its `scene:`.

    Raises:
        KeyError: nothing of this name is installed.
        UsageError: it cannot be loaded, or has another name than its entry point.
    """
    subject: Subject = extensions.load(extensions.SCENES, name)
    if (own := getattr(subject, "name", None)) != name:
        raise UsageError(
            "the entry point {name} is of {point}, whose name is {own}; the two must be the same",
            name=repr(name),
            point=extensions.described(extensions.find(extensions.SCENES, name)),
            own=repr(own),
        )
    return subject
