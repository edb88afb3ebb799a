"""What really happened in a run, recorded inside the simulator; judged and re-judged from disk.

`grader.recording.saving` describes a recording on disk.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cached_property
from typing import Annotated, Any, Final, Literal

from grader.recording.observations import Observations
from grader.recording.subject import Pictures, Pixels, Start, Trace, load_keeper
from grader.system.strict_json import SPARSE
from grader.text.message import Message, msg

Outcome = Literal["finished", "exited", "crashed", "stalled", "time_limit", "killed", "not_run"]
Clock = Literal["virtual", "real"]
#: Of what each program has printed, a run keeps so much beside the output of all [characters].
LONGEST_OUTPUT: Final = 4_000
#: A flag of a run whose launch file names a program that is not there.
NOT_THERE: Final = msg(
    "{file} starts {program}, which {set_up} does not install; it installs {names}"
)
#: So many programs a run may have at once: they share its limits.
MOST_PROGRAMS: Final = 8


def _a_value(value: Any) -> Any:
    """For `Annotated`: a number, true, false, or a text that means nothing in a template."""
    is_text = isinstance(value, str) and _TEXT.fullmatch(value) is not None
    if not is_text and type(value) not in (bool, int, float):
        raise ValueError(f"expected a number or a word, found {value!r:.80}")
    return value


_TEXT: Final = re.compile(r"[\w .-]{1,100}")
Value = Annotated[Any, _a_value]
#: What was drawn for a run, by its names.
Drawn = Mapping[str, Value]


@dataclass(frozen=True)
class ProgramRun:
    """How one of the submission's programs went.

    Attributes:
        name: as `ros2 launch` prints it, 'talker-1'; of a script that of its file.
        package, executable: what was started; '' and the file for a script.
        outcome, exit_code: as a run's.
        output: the end of what it has printed, at most `LONGEST_OUTPUT` characters.
    """

    name: str
    package: str
    executable: str
    outcome: Outcome
    exit_code: int | None = None
    output: str = ""


@dataclass(frozen=True)
class Run:
    """How the run went.

    Attributes:
        time: which clock the submission lived by.
        outcome: `finished` - its work came to rest, or was watched to the end; `exited`, `crashed`
            - the node ended by itself, without or with an error; `stalled` - it stopped
            responding; `time_limit` - it was still going; `killed` - somebody else killed it;
            `not_run` - a varied one was not begun, its only remark says why.
        exit_code: the node's, negative for a signal; None where it had to be stopped.
        ticks, simulated_s: how long the simulator recorded.
        wall_s: how long it took.
        trace_sha256: of the trace; equal hashes mean equal runs.
        isolation: what kept the run apart from others.
        flags: remarks on the run that a reader of the result should know.
        seed: chose where the varied runs start; None where there are none.
        interfaces: with which the scene was run; '' where it has no choice, or had none.
        case: of the exercise; '' for the usual one.
        drawn: the values that were drawn for this run, by their names.
        programs: of the submission, in the order of their start.
    """

    time: Clock = "real"
    outcome: Outcome = "finished"
    exit_code: int | None = None
    ticks: int = 0
    simulated_s: float = 0.0
    wall_s: float = 0.0
    trace_sha256: str = ""
    isolation: str = ""
    flags: tuple[Message, ...] = ()
    seed: int | None = None
    interfaces: str = field(default="", metadata=SPARSE)
    case: str = field(default="", metadata=SPARSE)
    drawn: Drawn = field(default_factory=dict, hash=False, metadata=SPARSE)
    programs: tuple[ProgramRun, ...] = field(default=(), metadata=SPARSE)


@dataclass(frozen=True)
class OwnInterfaces:
    """The interfaces that a submission's program gets: its own, and its exercise's.

    Attributes:
        texts: a type, 'my_interfaces/msg/Num' -> its definition, which may have a mistake.
        faults: its own types that it cannot import -> why not, and what to do.
        unlike: those that its exercise defines otherwise, or what is in them -> how.
    """

    texts: Mapping[str, str] = field(default_factory=dict)
    faults: Mapping[str, Message] = field(default_factory=dict)
    unlike: Mapping[str, Message] = field(default_factory=dict)

    @property
    def importable(self) -> dict[str, str]:
        """Those without a fault."""
        return {name: text for name, text in self.texts.items() if name not in self.faults}

    @property
    def packages(self) -> set[str]:
        return {name.partition("/")[0] for name in (*self.texts, *self.faults)}


@dataclass(frozen=True)
class PublishedTopic:
    """A topic that the submission published on, and its ROS type."""

    topic: str
    type: str


@dataclass(frozen=True)
class Provenance:
    """How the runs of a submission were made; nothing of it decides a verdict.

    Attributes:
        date: when they began, as `now` writes it.
        grader, python, rclpy: versions.
        ros_distro: the ROS 2 release that was sourced; '' where none was.
        submission: its name.
        submission_sha256: of all its files; see `grader.system.content`.
        exercise: its name.
        exercise_sha256: of all that it judges by.
        seed: chose where the varied runs start; None where there are none.
        conditions: the exercise's values that decide a run: "limits.total_s" -> 180.0.
    """

    date: str
    grader: str
    python: str
    rclpy: str
    ros_distro: str = ""
    submission: str = ""
    submission_sha256: str = ""
    exercise: str = ""
    exercise_sha256: str = ""
    seed: int | None = None
    conditions: Mapping[str, float] = field(default_factory=dict)


def now() -> str:
    """This moment, by the machine's clock: '2026-11-21T23:52:52Z'."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


@dataclass(frozen=True)
class Recording:
    """A run.

    Attributes:
        trace: what the scene recorded; `grader.scenes` says how that of each scene looks.
        run: how the run went.
        topics: what the submission published on.
        output: what the submission printed (start and end of it, if it was much).
        start: where the run began; None for the scene's usual place.
        scene: the name of the scene that made the trace.
        observations: what its process has reported; for words, not for points.
        cast: what the scripted peers beside another scene have recorded; None where there are none.
        package: what an inspection of the submission's package found, in the nominal run's: a trace
            of the scene `package`; None where it is in none, or the exercise inspects none.
        provenance: when and with what it was made; only the nominal run has it, for all.
        interfaces: those that the submission defines, and its exercise.
    """

    trace: Trace
    run: Run = field(default_factory=Run)
    topics: tuple[PublishedTopic, ...] = ()
    output: str = ""
    start: Start | None = None
    scene: str = "turtlesim"
    observations: Observations = field(default_factory=Observations)
    cast: Trace | None = None
    package: Trace | None = None
    provenance: Provenance | None = field(default=None, compare=False)
    interfaces: OwnInterfaces = field(default_factory=OwnInterfaces, compare=False)

    @cached_property
    def pictures(self) -> Pictures:
        """The pictures of the scene at the end."""
        return load_keeper(self.scene).pictures(self.trace)

    @cached_property
    def png(self) -> Mapping[str, bytes]:
        """The pictures of the scene at the end, as PNG files by their names.

        Encoding one takes longer than writing its file: the folder of the recording, the canvas
        beside the result and the page show the same one.
        """
        from PIL import Image  # here: the simulator's process imports this module too

        def encoded(pixels: Pixels) -> bytes:
            file = io.BytesIO()
            Image.fromarray(pixels).save(file, format="PNG")
            return file.getvalue()

        made = self.pictures
        named = {"window": made.window, **made.others}
        return {name: encoded(p) for name, p in named.items() if p is not None}

    @property
    def canvas(self) -> bytes:
        """The picture beside a result, a PNG; empty where the scene has none."""
        return self.png.get("window", b"")


@dataclass(frozen=True)
class Recordings:
    """The runs that are judged: the nominal one, and the varied ones, which start elsewhere.

    On disk the varied ones lie in folders `varied_1`, `varied_2`, ... inside the nominal one's.
    """

    nominal: Recording
    varied: tuple[Recording, ...] = ()

    def __iter__(self) -> Iterator[Recording]:
        yield self.nominal
        yield from self.varied


class NotOver(BaseException):
    """A check reads a varied run that is not over; no `except Exception` of its catches it."""


class NominalAlone(Recordings):
    """The nominal run, while the varied ones still go on: reading these raises `NotOver`."""

    def __init__(self, nominal: Recording) -> None:
        object.__setattr__(self, "nominal", nominal)

    def __getattribute__(self, name: str) -> object:
        if name == "varied":
            raise NotOver
        return super().__getattribute__(name)
