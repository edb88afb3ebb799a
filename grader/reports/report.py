"""What every format is made from: a result, and the picture and recordings that lie beside it."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from grader.errors import RecordingError
from grader.recording import folder as recordings
from grader.recording.recording import Recording
from grader.reports import text
from grader.result import result as results
from grader.result.result import Result
from grader.scenes import load_scene
from grader.scenes.scene import Scene

#: How the three verdicts are called.
WORDS = {"passed": "passed", "failed": "failed", "not_judged": "not judged"}
#: A text of a verdict is not shown beyond this; an exception's message has no length by nature.
_TEXT_LIMIT = 2000
_POINTS_LIMIT = 20


@dataclass(frozen=True)
class Point:
    """A piece of evidence.

    Attributes:
        number: 1, 2, ... over all verdicts; the same in the picture and in the text.
        verdict: the number of its verdict, from 0.
        run: 0 for the nominal run, 1, 2, ... for the varied ones.
        time_s: when [simulated s].
        x, y: where the turtle was [m].
        note: what happened there.
    """

    number: int
    verdict: int
    run: int
    time_s: float
    x: float
    y: float
    note: str

    @property
    def has_place(self) -> bool:
        """Whether the turtle was anywhere: a position can be NaN."""
        return math.isfinite(self.x) and math.isfinite(self.y)

    @property
    def where(self) -> str:
        """Time and place: 'at 12.34 s, at (5.54, 7.20)'."""
        run = f"varied run {self.run}, " if self.run else ""
        return f"{run}at {self.time_s:.2f} s, at {text.place(self.x, self.y)}"

    def __str__(self) -> str:
        return f"{self.where}: {self.note}"


@dataclass(frozen=True)
class ShownVerdict:
    """A verdict as reports show it.

    Attributes (the others are those of `grader.exercise.verdict.Verdict`):
        index: its number in the result, from 0.
        name: the check's name; no two verdicts have the same.
        points: its evidence.
        waited_for: what has to pass before this can be judged.
    """

    index: int
    name: str
    title: str
    status: str
    score: float
    max_score: float
    rationale: str
    help: str
    points: tuple[Point, ...]
    waited_for: tuple[str, ...]

    @property
    def passed(self) -> bool:
        """Whether it passed; not judged is not passed."""
        return self.status == "passed"

    @property
    def word(self) -> str:
        """The verdict in words."""
        return WORDS[self.status]

    @property
    def is_partial(self) -> bool:
        """Whether it failed, and earned points all the same."""
        return self.status == "failed" and self.score > 0

    @property
    def share(self) -> float:
        """How much of the points is earned, 0 to 1."""
        if self.max_score <= 0:
            return 1.0 if self.passed else 0.0
        return min(self.score / self.max_score, 1.0)

    @property
    def score_text(self) -> str:
        """The points: '12.5 / 30'."""
        return f"{text.points(self.score)} / {text.points(self.max_score)}"

    def lines(self) -> list[str]:
        """What was seen, where, and what to look at: for formats that show plain text."""
        lines = [text.one_line(self.rationale)]
        if self.waited_for:
            lines.append(f"Waits for: {', '.join(self.waited_for)}")
        lines += [f"- {text.one_line(str(point))}" for point in self.points]
        if self.help:
            lines.append(f"Look at: {text.one_line(self.help)}")
        return [line for line in lines if line]


class Report:
    """A result to be shown.

    Every text in it is plain (see `text.plain`), so a format only has to quote by its own rules.

    Args:
        result: as `grader.result` reads it.
        folder: where the result file lies; its artifacts are looked for below.
    """

    def __init__(self, result: Result, folder: Path) -> None:
        self.result: Result = text.plain_all(result)
        self.folder = folder
        self.exercise: str = text.one_line(self.result["exercise"]) or "(no name)"
        self.submission: str = text.one_line(self.result["submission"]) or "(no name)"
        self.score = float(self.result["score"])
        self.max_score = float(self.result["max_score"])
        self.run: dict[str, Any] = self.result["run"]
        self.varied_runs: list[dict[str, Any]] = self.result.get("varied_runs") or []

    @classmethod
    def read(cls, path: Path) -> Report:
        """Read a result file.

        Raises:
            UsageError: it cannot be read or is no result.
        """
        return cls(results.read(path), path.parent)

    @property
    def score_text(self) -> str:
        """The total: '87.5 of 100'."""
        return f"{text.points(self.score)} of {text.points(self.max_score)}"

    @cached_property
    def verdicts(self) -> tuple[ShownVerdict, ...]:
        """The verdicts in the order of the result."""
        listed = self.result["verdicts"]
        names = _distinct([text.one_line(verdict["check"]) for verdict in listed])
        status = {v["check"]: v["status"] for v in listed}
        shown: list[ShownVerdict] = []
        number = 1
        for index, (verdict, name) in enumerate(zip(listed, names, strict=True)):
            points = _points(verdict["evidence"][:_POINTS_LIMIT], index, number)
            number += len(points)
            waits = [n for n in verdict["depends_on"] if status.get(n, "passed") != "passed"]
            shown.append(
                ShownVerdict(
                    index,
                    name,
                    text.one_line(verdict["title"]),
                    verdict["status"],
                    float(verdict["score"]),
                    float(verdict["max_score"]),
                    text.clip(verdict["rationale"], _TEXT_LIMIT),
                    text.clip(verdict["help"], _TEXT_LIMIT),
                    points,
                    tuple(waits) if verdict["status"] == "not_judged" else (),
                )
            )
        return tuple(shown)

    @property
    def points(self) -> tuple[Point, ...]:
        """The evidence of all verdicts, by number."""
        return tuple(point for verdict in self.verdicts for point in verdict.points)

    @property
    def first_to_mend(self) -> ShownVerdict | None:
        """The first verdict that failed or, failing that, could not be given; None without any."""
        return next(
            (v for status in ("failed", "not_judged") for v in self.verdicts if v.status == status),
            None,
        )

    @property
    def headline(self) -> str:
        """One line: what to mend first."""
        first = self.first_to_mend
        if first is not None:
            return text.one_line(first.rationale) or f"{first.name}: {first.word}"
        return f"Nothing to mend: all {len(self.verdicts)} checks passed."

    @cached_property
    def canvas_path(self) -> Path | None:
        """The picture of the window at the end; None where there is none."""
        return self._artifact("canvas")

    @cached_property
    def recordings(self) -> dict[int, Recording]:
        """The recordings that can be read, by run: 0 nominal, 1, 2, ... varied."""
        return {run: r for run, r in self._loaded.items() if isinstance(r, Recording)}

    @cached_property
    def scene(self) -> Scene:
        """What ran beside the submission; where no recording tells, the first there was."""
        known = self.recordings.get(0)
        return load_scene(known.scene if known else recordings.FIRST_SCENE)

    def no_recording(self, run: int) -> str:
        """Why a run has no recording."""
        reason = self._loaded.get(run)
        return text.plain(reason) if isinstance(reason, str) else "no recording lies beside it"

    @cached_property
    def _loaded(self) -> dict[int, Recording | str]:
        """A recording for each run, or why it cannot be read."""
        base = self._artifact("recording")
        if base is None:
            return {}
        loaded: dict[int, Recording | str] = {}
        for run in range(len(self.varied_runs) + 1):
            try:
                loaded[run] = recordings.load(base / f"varied_{run}" if run else base)
            except RecordingError as error:
                loaded[run] = str(error)
        return loaded

    @cached_property
    def output(self) -> str:
        """What the node printed in the nominal run."""
        path = self._artifact("output")
        if path is not None and path.is_file():
            return text.plain(path.read_text(encoding="utf-8", errors="replace"))
        return text.plain(self.recordings[0].output) if 0 in self.recordings else ""

    def _artifact(self, name: str) -> Path | None:
        """Where an artifact lies; None if it is not there or not below the result's folder."""
        relative = self.result["artifacts"].get(name)
        if not relative:
            return None
        folder = self.folder.resolve()
        path = (folder / relative).resolve()
        return path if path.is_relative_to(folder) and path.exists() else None


def _points(evidence: list[dict[str, Any]], verdict: int, first: int) -> tuple[Point, ...]:
    return tuple(
        Point(
            number,
            verdict,
            int(item.get("run", 0)),
            float(item["time_s"]),
            float(item["x"]),
            float(item["y"]),
            text.clip(text.one_line(item["note"]), _TEXT_LIMIT),
        )
        for number, item in enumerate(evidence, first)
    )


def _distinct(names: list[str]) -> list[str]:
    """The names, none empty and no two alike: some systems drop what is called the same."""
    seen: Counter[str] = Counter()
    distinct: list[str] = []
    for index, name in enumerate(names, 1):
        base = name or f"check {index}"
        seen[base] += 1
        candidate = base if seen[base] == 1 else f"{base} ({seen[base]})"
        while candidate in distinct:
            candidate += "'"
        distinct.append(candidate)
    return distinct
