"""What really happened in a run, taken inside the simulator; judged and re-judged from disk.

On disk a recording is a folder: `recording.json`, `path.png` (what the pens drew, RGBA) and
`window.png` (what the original's window would show at the end). The JSON holds the same `scenario`
and `published` as the files that `turtlesim_py.scenario` reads and writes, so a run can be replayed
without ROS.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
from PIL import Image

from turtlesim_py.replay import COLUMNS, number
from turtlesim_py.world.turtle import TICK_S

SCHEMA = "turtlesim-grader/recording/v1"
FILE, PATH_FILE, WINDOW_FILE = "recording.json", "path.png", "window.png"
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
        events: every input to the arena, as scenario events `{tick, op, ...}`, in order.
        published: turtle -> float64 array (rows, 9) of `COLUMNS`; float32 values.
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
        folder.mkdir(parents=True, exist_ok=True)
        Image.fromarray(self.canvas).save(folder / PATH_FILE)
        Image.fromarray(self.window).save(folder / WINDOW_FILE)
        data = {
            "schema": SCHEMA,
            "scenario": {
                "name": "recording",
                "description": "a graded run",
                "ticks": self.run.ticks,
                "events": self.events,
            },
            "tick_seconds": TICK_S,
            "columns": COLUMNS,
            "published": {name: _rows(array) for name, array in self.published.items()},
            "logs": self.logs,
            "topics": self.topics,
            "output": self.output,
            "run": asdict(self.run),
            "start": asdict(self.start) if self.start else None,
        }
        (folder / FILE).write_text(json.dumps(data), encoding="utf-8")


def load(folder: Path) -> Recording:
    """Read a recording back.

    Raises:
        RecordingError: the folder or one of its files is missing or is something else.
    """
    path = folder / FILE if folder.is_dir() else folder
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        if data.get("schema") != SCHEMA:
            raise RecordingError(
                f"{path} is no recording: expected schema {SCHEMA!r}, found {data.get('schema')!r}"
            )
        run = {**data["run"], "flags": tuple(data["run"]["flags"])}
        return Recording(
            events=tuple(data["scenario"]["events"]),
            published={name: _array(rows) for name, rows in data["published"].items()},
            logs=tuple(data["logs"]),
            canvas=_pixels(path.parent / PATH_FILE, "RGBA"),
            window=_pixels(path.parent / WINDOW_FILE, "RGB"),
            topics=tuple(data["topics"]),
            output=data["output"],
            run=Run(**run),
            start=Start(**data["start"]) if data.get("start") else None,
        )
    except OSError as error:
        raise RecordingError(f"cannot read the recording: {error}") from None
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise RecordingError(f"{path} is damaged: {error!r}") from None


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
        self.nominal.save(folder)
        for index, recording in enumerate(self.varied, 1):
            recording.save(folder / f"varied_{index}")


def load_all(folder: Path) -> Recordings:
    """Read a nominal recording and the varied ones in it.

    Raises:
        RecordingError: one of them cannot be judged.
    """
    nominal = load(folder)
    base = folder if folder.is_dir() else folder.parent
    return Recordings(nominal, tuple(load(path) for path in sorted(base.glob("varied_*"))))


def _pixels(path: Path, mode: str) -> npt.NDArray[np.uint8]:
    with Image.open(path) as image:
        return np.asarray(image.convert(mode))


def _rows(array: npt.NDArray[np.float64]) -> list[list[Any]]:
    return [[number(value) for value in row] for row in array.tolist()]


def _array(rows: list[list[Any]]) -> npt.NDArray[np.float64]:
    array = np.array(rows, dtype=np.float64).reshape(-1, len(COLUMNS))
    # Nine digits name a float32 without doubt; give it back its exact value.
    array[:, 1:6] = array[:, 1:6].astype(np.float32)
    return array
