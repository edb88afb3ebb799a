"""What a recording is of: a scene that ran beside a submission, or an inspected package.

A `Keeper` knows how its traces are kept in a bag and read back. Nothing here needs ROS, and readers
of recordings know no more of a scene; how it is shown, `grader.scenes.subject` knows.
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
from typing import Any, ClassVar, Final, Literal, NamedTuple, Protocol, Self

import numpy as np
import numpy.typing as npt

from grader.errors import SceneFailure, SubmissionError, UsageError
from grader.recording.mcap import Channel
from grader.system import extensions
from grader.system.strict_json import SPARSE
from grader.text.message import Message, msg
from grader.text.strings import place, shown

#: The scene of an exercise that names none.
DEFAULT_SCENE: Final = "turtlesim"
#: Hooks of a subject, and of a scene, and what they may raise; `from_channels` may raise
#: anything.
HOOKS: Final[Mapping[str, tuple[type[Exception], ...]]] = {
    **dict.fromkeys(("untouched", "definitions_of", "to_messages"), ()),
    **dict.fromkeys(("bag_topics", "scenario", "view", "pictures"), ()),
    **dict.fromkeys(("remarks", "endpoints", "wrong_setting", "adapted", "how_to_try"), ()),
    **dict.fromkeys(("odd_traces", "within", "simulate", "preload", "starts"), ()),
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
Pixels = npt.NDArray[np.uint8]


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


@dataclass(frozen=True)
class Pictures:
    """The pictures of a recording by name.

    Attributes:
        window: the scene's plane at the end; None where there is nothing to see.
    """

    window: Pixels | None = None
    others: Mapping[str, Pixels] = field(default_factory=dict)


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


class OneTrace:
    """What classes of traces have in common."""

    @classmethod
    def of(cls, trace: object) -> Self:
        """Narrow the type of a recording's trace.

        Raises:
            TypeError: it is a trace of another subject.
        """
        if not isinstance(trace, cls):
            raise TypeError(f"expected a {cls.__name__}, found a {type(trace).__name__}")
        return trace


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


class Keeper(ABC):
    """Keeps traces. The abstract members are obligatory, the others have defaults."""

    #: In an exercise, and of its entry point (`grader.scenes`).
    name: ClassVar[str]
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

    def pictures(self, trace: Trace) -> Pictures:
        """Draw the scene at the end."""
        return Pictures()


def load_keeper(name: str) -> Keeper:
    """Load the keeper of the traces of a scene, or of packages.

    Raises:
        KeyError: nothing of this name is installed.
        UsageError: it cannot be loaded, or has another name than its entry point.
    """
    keeper: Keeper = extensions.load(extensions.SCENES, name)
    if (own := getattr(keeper, "name", None)) != name:
        raise UsageError(
            "the entry point {name} is of {point}, whose name is {own}; the two must be the same",
            name=repr(name),
            point=extensions.described(extensions.find(extensions.SCENES, name)),
            own=repr(own),
        )
    return keeper
