"""The interface of a scene, which runs beside a submission.

A scene has nodes, a tick, places to start, a trace that it records, and a rule that ends a run.
Runs in real and in virtual time use it by `Scene` alone, recordings and reports by
`grader.scenes.subject.Subject`. Its part in the simulator's process is a `Simulation`; the rest
needs no ROS. A scene knows nothing of exercises, submissions and results.
"""

from __future__ import annotations

import shlex
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any, ClassVar, Final, Literal, get_args

from grader.errors import SceneFailure
from grader.recording.subject import LONGEST_WORDS, Start, Trace
from grader.scenes.live import LivePage
from grader.scenes.subject import Subject, load_subject
from grader.text.message import Message, msg

#: Why a run is over: it came to rest, it was seen to its end, nothing ever moved, the submission
#: is gone, time is up.
Reason = Literal["", "rest", "seen", "no_motion", "gone", "time_limit"]

#: How often `Simulation.tick` is called [simulated ns].
STEP_NS: Final = 16_000_000
#: How long after its exit a submission's last messages may still arrive [ticks].
GRACE_TICKS: Final = 31


@dataclass(frozen=True)
class Limits:
    """When a run ends, in simulated seconds.

    Attributes:
        first_motion_s: if nothing has moved by then.
        rest_s: after a rest of this length, once something has driven; before that, a rest may be
            as long as `first_motion_s`.
        total_s: in any case.
    """

    first_motion_s: float
    rest_s: float
    total_s: float


@dataclass(frozen=True)
class Introduction:
    """What a submission's process has to know of a scene to communicate with it.

    Attributes:
        nodes: the names and namespaces of the scene's nodes.
        topics, services: names that a submission drives the scene by, and that exist from the
            start. In real time its publishers and clients of these wait until they are connected;
            those of names that end like them, for a while.
        compares_stamps: whether equal stamps matter. In virtual time a callback takes no time; a
            node's clock then returns a later time when it is read again.
    """

    nodes: tuple[tuple[str, str], ...]
    topics: tuple[str, ...]
    services: tuple[str, ...]
    compares_stamps: bool = False


@dataclass(frozen=True)
class Hooks:
    """The connections of a run with its simulation.

    Attributes:
        has_unread: whether anything has arrived; while nothing has, a node need not be served.
        send_news: receives after each tick what viewers see, as plain data for the live page of
            the scene (`grader.scenes.live`); None where there is no audience.
        cast: the exercise's, at work (`grader.scenes.cast.playing.Playing`), or None.
    """

    has_unread: Callable[[], bool] = lambda: True
    send_news: Callable[[Mapping[str, Any]], None] | None = None
    cast: Any = None


@dataclass(frozen=True)
class Forecast:
    """The messages of the next ticks if nothing arrives.

    Attributes:
        publishers: rclpy's, each of which publishes once in each of these ticks.
        ticks: for each tick the messages, in the order of the publishers, in CDR.
    """

    publishers: tuple[Any, ...]
    ticks: list[tuple[bytes, ...]]


class Simulation(ABC):
    """A scene at work, in the simulator's process, where ROS is up.

    Abstract are `node`, `ticks`, `tick` and `trace`.

    Attributes:
        node: an `rclpy.node.Node`, to query the graph.
        records: whether ticks are recorded; inputs always are.
        gone_tick: the last tick before the end of the submission's process; None while it lives.
    """

    node: Any

    def __init__(self) -> None:
        self.records = False
        self.gone_tick: int | None = None

    @property
    @abstractmethod
    def ticks(self) -> int:
        """The number of recorded ticks, each of `STEP_NS`."""

    @abstractmethod
    def tick(self, now_ns: int | None = None) -> Reason:
        """Serve what has arrived and let a tick pass; return why the run is over, or ''.

        Args:
            now_ns: the time on the clock of the run [ns]; without it, a node's clock is read.
        """

    @abstractmethod
    def trace(self) -> Trace:
        """Return the recording up to now."""

    @property
    def is_at_rest(self) -> bool:
        """Whether the driven thing has moved, and rests now."""
        return False

    @property
    def flags(self) -> tuple[Message, ...]:
        """Remarks for the result: requests of the submission that were refused."""
        return ()

    def record(self) -> None:
        """Record from the next tick on."""
        self.records = True

    def submission_gone(self) -> None:
        """Note that the submission's process has ended."""
        self.gone_tick = self.ticks

    def foresee(self, most: int) -> Forecast:
        """Return at most so many of the next ticks that are certain if nothing arrives.

        There is none where the run might end, a node is to be served, or something other than
        publishing would happen. If a scene foresees nothing, `tick` is called each time: slower.
        """
        return Forecast((), [])

    def pass_tick(self, now_ns: int) -> tuple[Reason, tuple[bytes, ...]]:
        """Let a foreseen tick pass without publishing; return as `tick`, and the messages."""
        raise NotImplementedError("a scene that foresees ticks has to let them pass")

    def over(self, tick: int, limits: Limits, has_begun: bool) -> Reason:
        """Return why a run ends after a tick, or ''; for scenes that never come to rest.

        Args:
            has_begun: whether the submission has acted on the scene.
        """
        if self.gone_tick is not None and tick - self.gone_tick >= GRACE_TICKS:
            return "gone"
        now_s = tick * STEP_NS / 1e9
        if not has_begun and now_s >= limits.first_motion_s:
            return "no_motion"
        if now_s >= limits.total_s:
            return "seen" if has_begun else "no_motion"
        return ""


def expect_reason(scene: str, found: Reason) -> Reason:
    """Return what a scene has returned for a tick; raise a `SceneFailure` where it is no reason."""
    if found not in (known := get_args(Reason)):
        shown = {"found": repr(found)[:LONGEST_WORDS], "known": ", ".join(map(repr, known))}
        failed = msg(
            "the scene {scene} returned {found}, expected one of {known}", scene=scene, **shown
        )
        raise SceneFailure(failed)
    return found


def arrived(subscription: Any) -> Iterator[Any]:
    """Receive all messages that have arrived, without an executor and without waiting."""
    while (found := subscription.handle.take_message(subscription.msg_type, False)) is not None:
        yield found[0]


class Scene(Subject):
    """A kind of scene; all but `simulate` works without ROS.

    Required are a name, the words for the driven thing, `simulate`, and how a trace is written and
    read; see `Subject`.
    """

    #: For a submission's process.
    introduction: ClassVar[Introduction] = Introduction((), (), ())
    #: The farthest start from the usual place that leaves room on every side [m].
    farthest_start_m: ClassVar[float] = 0.0
    #: Where a run begins that is given no start; None where a scene obeys no `Start.speed`.
    usual_start: ClassVar[Start | None] = None

    @abstractmethod
    def simulate(
        self, limits: Limits, start: Start | None, hooks: Hooks, interfaces: str, setting: str
    ) -> Simulation:
        """Make the simulation, in the simulator's process; ROS is up.

        Args:
            interfaces: from `interfaces_for`; '' for the usual ones.
            setting: of the exercise; see `wrong_setting`.
        """

    def preload(self) -> None:
        """Import and make what all simulations share; ROS is not up."""
        return

    def starts(self, count: int, seed: int, nearest_m: float, farthest_m: float) -> list[Start]:
        """Return starts for varied runs, so far from the usual place; the same for the same seed.

        There are none where nothing can be varied.
        """
        return []

    def interfaces_for(self, surely: Mapping[str, str], perhaps: Mapping[str, str]) -> str:
        """Return which interfaces a submission was written for; '' where there is no choice.

        Args:
            surely: the modules that the submission always imports, each with the place of its
                first import, in the order of these.
            perhaps: likewise those that it may import.

        Raises:
            SubmissionError: it fits none of them.
        """
        return ""

    def live_page(self, port: int) -> LivePage | None:
        """Serve a page that shows runs live; None where the scene has none.

        Args:
            port: 0 for any that is free.

        Raises:
            OSError: the page cannot be served.
        """
        return None


def command_by_hand(program: str, package: str) -> str:
    """Return the command that starts a node by hand as it is graded, for exercise sheets.

    A file in a package is run as a module, so that it can import the package by its name: in the
    folder of the package, since elsewhere another module of that name may be started.

    Args:
        program: the node's file, relative to the folder above that of the submission.
        package: of the file; '' for none.
    """
    folder, *inside = PurePath(program).with_suffix("").parts
    if package and len(inside) > 1:
        return f"(cd {shlex.quote(folder)} && python3 -m {'.'.join(inside)})"
    return f"python3 {shlex.quote(program)}"


def load_scene(name: str) -> Scene:
    """Load the scene of this name.

    Raises:
        KeyError: there is none.
    """
    scene = load_subject(name)
    if not isinstance(scene, Scene):
        raise KeyError(f"{name!r} is no scene: nothing runs beside a submission")
    return scene
