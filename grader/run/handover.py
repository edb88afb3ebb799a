"""The plan that the grader passes to a simulator's process, and the recording that comes back.

The plan is an argument. The recording is a file: facts as a line of JSON, then the bag
(`grader.recording.bag`). Nothing is unpickled: a pickle could have the grader do anything.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

from grader.errors import GraderFailure, SceneFailure
from grader.recording import bag
from grader.recording.mcap import read_mcap
from grader.recording.recording import Drawn, PublishedTopic
from grader.recording.scene_and_cast import CastKeeper, merge
from grader.recording.subject import Keeper, Start, Trace
from grader.run.limits import RECORDING_BYTES, CpuBudget
from grader.scenes.scene import Limits
from grader.system.strict_json import OURS, SPARSE, UNSTORED, from_json, to_json
from grader.text.message import Message, msg


@dataclass(frozen=True)
class Plan:
    """One run.

    Attributes:
        limits: when it ends.
        start: where it begins; None for the scene's usual place.
        scene: the name of the scene that runs beside the submission.
        seed: the seed of the varied runs beside this one, for the record.
        flags: remarks that are known before it begins.
        interfaces: the interfaces that the submission was written for, where the scene has several;
            '' for the scene's usual ones.
        setting: the exercise's setting of the scene; '' for none.
        looks_at_package: whether the package around the submission's program is inspected as well.
        inspections: the names of the inspectors that examine a package.
        definitions: the exercise's interfaces: a type -> its definition.
        cast: its scripted peers, as `grader.scenes.cast.script` reads them; None for none.
        hears: topics that are recorded besides those that the peers hear.
        own_definitions: a hand-in's interfaces, for a cast alone: nothing imports them.
        arguments: those that the program is started with.
        case: of the exercise; '' for the usual one.
        drawn: the values that were drawn for it.
        budget: that of the whole grading, which the simulator's process does not know.
    """

    limits: Limits
    start: Start | None = None
    scene: str = "turtlesim"
    seed: int | None = None
    flags: tuple[Message, ...] = ()
    interfaces: str = ""
    setting: str = ""
    looks_at_package: bool = False
    inspections: tuple[str, ...] = ()
    definitions: Mapping[str, str] = field(default_factory=dict, hash=False, metadata=SPARSE)
    cast: Mapping[str, Any] | None = field(default=None, hash=False, metadata=SPARSE)
    hears: tuple[str, ...] = field(default=(), metadata=SPARSE)
    own_definitions: Mapping[str, str] = field(default_factory=dict, hash=False, metadata=SPARSE)
    arguments: tuple[str, ...] = field(default=(), metadata=SPARSE)
    case: str = field(default="", metadata=SPARSE)
    drawn: Drawn = field(default_factory=dict, hash=False, metadata=SPARSE)
    budget: CpuBudget = field(default_factory=CpuBudget, compare=False, metadata=UNSTORED)

    def to_json(self) -> str:
        """Serialise it as an argument of the simulator's process."""
        return json.dumps(to_json(self, OURS))

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Parse what `to_json` has written."""
        return from_json(cls, json.loads(text), OURS)


# The recording --------------------------------------------------------------------------------


def keeper(plan: Plan, scene: Keeper) -> Keeper:
    """Return what keeps the trace of a run: with a cast beside a scene, that of both."""
    return scene if plan.cast is None or scene.has_cast else CastKeeper(scene)


#: Every node has these, and ROS publishes on them by itself.
USUAL = ("/rosout", "/parameter_events")


@dataclass(frozen=True)
class _Facts:
    """What a file has before its bag.

    Attributes:
        topics: on which the submission has published, with their types.
        duration_ns: how long was recorded [ns].
        sha256: of the trace.
    """

    topics: Mapping[str, str]
    duration_ns: int
    sha256: str


def leave(
    path: Path, scene: Keeper, trace: Trace, published: Mapping[str, str], cast: Any = None
) -> None:
    """Write the file, in the simulator's process.

    Args:
        published: the topics on which the submission has published: topic -> type.
        cast: that of the run (`grader.scenes.cast.playing`); None for none.
    """
    is_beside = cast is not None and not scene.has_cast
    kept, by = merge(trace, cast.trace(trace.ticks) if is_beside else None, scene)
    topics = {topic: kind for topic, kind in sorted(published.items()) if topic not in USUAL}
    facts = to_json(_Facts(topics, kept.duration_ns, kept.sha256()), OURS)
    head = json.dumps(facts).encode()
    path.write_bytes(head + b"\n" + bag.pack(kept, by)[0])


def fetch(file: int, scene: Keeper) -> tuple[Trace, tuple[PublishedTopic, ...]]:
    """Read the file from an open descriptor, in the grader's process.

    Raises:
        SceneFailure: the scene's own `from_channels` fails.
        GraderFailure: it is no such file.
    """
    failure = GraderFailure
    try:
        head, _, packed = read_bounded(file, RECORDING_BYTES).partition(b"\n")
        # of bytes, json.loads would guess the encoding
        facts = from_json(_Facts, json.loads(head.decode("utf-8")), OURS)
        channels = read_mcap(packed, RECORDING_BYTES)
        failure = SceneFailure
        trace = bag.parse_channels(channels, scene, facts.duration_ns, facts.sha256)
        return trace, tuple(PublishedTopic(*topic) for topic in facts.topics.items())
    except Exception as error:
        why = f"{type(error).__name__}: {error}"[:200]
        raise failure(msg("the simulator left no recording: {why}", why=why)) from error


def read_bounded(file: int, most_bytes: int) -> bytes:
    """Return the contents of an open file."""
    with open(file, "rb", closefd=False) as opened:
        opened.seek(0)
        data = opened.read(most_bytes + 1)
    if len(data) > most_bytes:
        raise ValueError(f"more than {most_bytes} bytes")
    return data
