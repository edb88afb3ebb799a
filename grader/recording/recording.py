"""What really happened in a run, taken inside the simulator; judged and re-judged from disk.

How a recording lies on disk is told by `grader.recording.folder` and `grader.recording.bag`. They
are imported where they are needed: they know this module, and rosbags takes a tenth of a second to
import.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from turtlesim_py.world.turtle import TICK_S

Outcome = Literal["finished", "exited", "crashed", "stalled", "time_limit", "killed"]


class RecordingError(Exception):
    """The folder holds no recording that can be judged; the text says why."""


@dataclass(frozen=True)
class Run:
    """How the run went.

    Attributes:
        time: which clock the submission lived by.
        outcome: `finished` - the turtle came to rest; `exited`, `crashed` - the node ended by
            itself, without or with an error; `stalled` - it stopped responding; `time_limit` - it
            was still going; `killed` - somebody else killed it.
        exit_code: the node's, negative for a signal; None where it had to be stopped.
        ticks, simulated_s: how long the simulator recorded.
        wall_s: how long it took.
        trace_sha256: of every pose and every input; equal hashes mean equal runs.
        isolation: what kept the run apart from others.
        flags: remarks on the run that a reader of the result should know.
        seed: chose where the varied runs start; None where there are none.
    """

    time: Literal["virtual", "real"] = "real"
    outcome: Outcome = "finished"
    exit_code: int | None = None
    ticks: int = 0
    simulated_s: float = 0.0
    wall_s: float = 0.0
    trace_sha256: str = ""
    isolation: str = ""
    flags: tuple[str, ...] = ()
    seed: int | None = None


@dataclass(frozen=True)
class Start:
    """Where turtle1 stands when a run begins: x, y [m], theta [rad]."""

    x: float
    y: float
    theta: float


@dataclass(frozen=True)
class Recording:
    """A run.

    Attributes:
        events: every input to the arena, as scenario events `{tick, op, ...}`, as they came.
        published: turtle -> float64 array (rows, 9) of `turtlesim_py.replay.COLUMNS`;
            float32 values, whole ticks and colours.
        logs: [tick, severity, logger, text].
        canvas: the drawn path at the end, uint8 array (500, 500, 4), alpha 0 where unpainted.
        window: path, background and turtles at the end, uint8 array (500, 500, 3).
        topics: what the submission published on: {"topic", "type"}.
        output: what the submission printed (start and end of it, if it was much).
        run: how the run went.
        start: where the turtle was put before the run; None for its usual place.
    """

    events: tuple[dict[str, Any], ...]
    published: dict[str, npt.NDArray[np.float64]]
    logs: tuple[list[Any], ...]
    canvas: npt.NDArray[np.uint8]
    window: npt.NDArray[np.uint8]
    topics: tuple[dict[str, str], ...] = ()
    output: str = ""
    run: Run = field(default_factory=Run)
    start: Start | None = None

    def calls(self, op: str, turtle: str = "turtle1") -> list[dict[str, Any]]:
        """The inputs of one kind that went to one turtle."""
        return [e for e in self.events if e["op"] == op and e.get("turtle", turtle) == turtle]

    def finished(self, **run: Any) -> Recording:
        """The same recording with more known about its run, and its hash."""
        digest = hashlib.sha256()
        for name in sorted(self.published):
            digest.update(name.encode())
            digest.update(self.published[name].tobytes())
        digest.update(json.dumps(self.events).encode())
        ticks = int(run.pop("ticks", self.run.ticks))
        return replace(
            self,
            run=replace(
                self.run,
                ticks=ticks,
                simulated_s=round(ticks * TICK_S, 3),
                trace_sha256=digest.hexdigest(),
                **run,
            ),
        )

    def save(self, folder: Path) -> None:
        """Write the recording into a folder, which is made if need be."""
        from grader.recording import folder as storage

        storage.save(self, folder)


@dataclass(frozen=True)
class Recordings:
    """What is judged: the nominal run, and the varied ones, which start elsewhere.

    On disk the varied ones lie in folders `varied_1`, `varied_2`, ... inside the nominal one's.
    """

    nominal: Recording
    varied: tuple[Recording, ...] = ()

    def __iter__(self) -> Iterator[Recording]:
        yield self.nominal
        yield from self.varied

    def save(self, folder: Path) -> None:
        """Write all recordings."""
        from grader.recording import folder as storage

        storage.save_all(self, folder)


def load(folder: Path) -> Recording:
    """Read a recording back.

    Raises:
        RecordingError: the folder or one of its files is missing or is something else.
    """
    from grader.recording import folder as storage

    return storage.load(folder)


def load_all(folder: Path) -> Recordings:
    """Read a nominal recording and the varied ones in it.

    Raises:
        RecordingError: one of them cannot be judged.
    """
    from grader.recording import folder as storage

    return storage.load_all(folder)
