"""What a scene is: whatever runs beside a submission, and everything that only it can know.

A scene has nodes, a tick, a place where things start, something that it records, and a rule for
when a run is over. Runs in real and in virtual time know it by `Scene` alone, recordings and
reports by `grader.recording.subject.Subject`. What it does in the simulator's process is its
`Simulation`; the rest needs no ROS. A scene knows nothing of exercises, submissions and results.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any, ClassVar, Final, Literal

from grader.message import Message
from grader.recording.subject import Start, Subject, Trace
from grader.scenes.live import LivePage

#: Why a run is over: it came to rest, all that there is to see was seen, nothing ever moved, the
#: submission is gone, time is up.
Reason = Literal["", "rest", "seen", "no_motion", "gone", "time_limit"]

#: How often `Simulation.tick` is called [simulated ns].
STEP_NS: Final = 16_000_000
#: How long after its exit a submission's last messages may still arrive [ticks].
GRACE_TICKS: Final = 31


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


class Simulation(ABC):
    """A scene at work, in the simulator's process, when ROS is up there.

    Obligatory are a node, how many ticks were recorded, what a tick does, and the trace.

    Attributes:
        node: to ask what others publish, an `rclpy.node.Node`.
        records: whether ticks are recorded; inputs are from the beginning.
        gone_tick: after which the submission's process had ended; None while it lives.
    """

    node: Any

    def __init__(self) -> None:
        self.records = False
        self.gone_tick: int | None = None

    @property
    @abstractmethod
    def ticks(self) -> int:
        """How many ticks were recorded, each of `STEP_NS`."""

    @abstractmethod
    def tick(self, now_ns: int | None = None) -> Reason:
        """Serve what has arrived, let a tick pass; why the run is over, or ''.

        Args:
            now_ns: the time on the clock of the run [ns], where somebody knows; else a node's
                clock is asked.
        """

    @abstractmethod
    def trace(self) -> Trace:
        """Everything recorded up to now."""

    @property
    def is_at_rest(self) -> bool:
        """Whether what is driven has moved, and does not now."""
        return False

    @property
    def flags(self) -> tuple[Message, ...]:
        """Remarks for the result: what the submission asked for and did not get."""
        return ()

    def record(self) -> None:
        """Record from the next tick on."""
        self.records = True

    def submission_gone(self) -> None:
        """The submission's process has ended."""
        self.gone_tick = self.ticks

    def foresee(self, most: int) -> Forecast:
        """The next ticks, so many at most: as far as they are certain if nothing arrives.

        None where the run might end, a node is to be served, or something other than publishing
        would happen. A scene that foresees nothing is asked for every tick, which takes longer.
        """
        return Forecast((), [])

    def pass_tick(self, now_ns: int) -> tuple[Reason, tuple[bytes, ...]]:
        """As `tick`, in a tick that was foreseen: publishes nothing, returns what it would have."""
        raise NotImplementedError("a scene that foresees ticks has to let them pass")

    def over(self, tick: int, limits: Limits, has_begun: bool) -> Reason:
        """Why a run ends after a tick, or '': where what was begun is never done.

        Args:
            has_begun: whether the submission has done anything that the scene is about.
        """
        if self.gone_tick is not None and tick - self.gone_tick >= GRACE_TICKS:
            return "gone"
        now_s = tick * STEP_NS / 1e9
        if not has_begun and now_s >= limits.first_motion_s:
            return "no_motion"
        if now_s >= limits.total_s:
            return "seen" if has_begun else "no_motion"
        return ""


def arrived(subscription: Any) -> Iterator[Any]:
    """Take all messages that have arrived, without an executor: nothing here waits."""
    while (taken := subscription.handle.take_message(subscription.msg_type, False)) is not None:
        yield taken[0]


class Scene(Subject):
    """A kind of scene; all of it but `simulate` works without ROS.

    Obligatory are a name, the words for what is driven, `simulate`, and how a trace is kept and
    read back; see `Subject`.
    """

    #: What a submission's process has to know of it.
    introduction: ClassVar[Introduction] = Introduction((), (), ())
    #: So far from the usual place something can start and still has room on every side [m].
    farthest_start_m: ClassVar[float] = 0.0

    @abstractmethod
    def simulate(
        self, limits: Limits, start: Start | None, hooks: Hooks, interfaces: str, setting: str
    ) -> Simulation:
        """Make the nodes and everything else; ROS is up, in the simulator's process.

        Args:
            interfaces: from `interfaces_for`; '' for the usual ones.
            setting: what the exercise sets it up with; see `wrong_setting`.
        """

    def preload(self) -> None:
        """Import and make what is the same in every simulation; nothing of ROS is up."""
        return

    def starts(self, count: int, seed: int, nearest_m: float, farthest_m: float) -> list[Start]:
        """Where varied runs start, so far from the usual place; the same for the same seed.

        None where nothing can be varied.
        """
        return []

    def interfaces_for(self, surely: Mapping[str, str], perhaps: Mapping[str, str]) -> str:
        """Which of its interfaces a submission was written for; '' where there is no choice.

        Args:
            surely, perhaps: the modules that the submission imports whenever it is run, and those
                that it may import, each with the place of the first import, in the order of these.

        Raises:
            SubmissionError: it cannot have been written for any.
        """
        return ""

    def live_page(self, port: int) -> LivePage | None:
        """A page on which runs are seen while they go on; None where there is none.

        Args:
            port: 0 for any that is free.

        Raises:
            OSError: it cannot be served.
        """
        return None


def command_by_hand(program: str, package: str) -> str:
    """The command that starts a student's node by hand as it is graded, for exercise sheets.

    A package's own modules are found by the package's name.

    Args:
        program: the node's file, below the folder that is handed in.
        package: which it is in; '' for none.
    """
    path = PurePath(program)
    if package and len(path.parts) > 1:
        return f"python3 -m {'.'.join(path.with_suffix('').parts)}"
    return f"python3 {program}"
