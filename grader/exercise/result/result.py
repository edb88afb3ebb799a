"""The result file `turtlesim-grader/result/v1`: one judged run, for people's tools.

Its JSON Schema is `result.schema.json` beside this module.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from datetime import datetime
from pathlib import Path
from typing import Any, ClassVar, Self

from grader.exercise.exercise import Exercise
from grader.exercise.policies import Late, LatePolicy
from grader.exercise.result import json_file
from grader.exercise.result.diagnosis import Diagnosis
from grader.exercise.sentences import not_followed, remarks
from grader.exercise.verdict import Verdict
from grader.recording.recording import Provenance, Recording, Recordings, Run, now
from grader.recording.subject import Start
from grader.system import files
from grader.system import versions as system
from grader.system.strict_json import SPARSE

#: The beginning of the schemas of all versions.
FAMILY = "turtlesim-grader/result/"
SCHEMA = f"{FAMILY}v1"
#: Files that `grader run` writes beside a result file: name -> path relative to it.
ARTIFACTS = {"canvas": "canvas.png", "recording": "recording", "output": "output.txt"}
#: Its parts in the order for a reader: the result before how it was made.
IN_ORDER = (
    *("exercise", "submission", "score", "max_score", "handed_in", "not_shown", "diagnosis"),
    *("verdicts", "run", "varied_runs", "artifacts", "provenance"),
)


def artifacts(nominal: Recording) -> dict[str, str]:
    """Return the files beside a result; a canvas only where the scene draws one."""
    return {name: at for name, at in ARTIFACTS.items() if name != "canvas" or nominal.canvas}


def put_artifacts(nominal: Recording, folder: Path) -> None:
    """Write canvas and output beside a result; the recording is written elsewhere.

    Raises:
        UsageError: it cannot be written.
    """
    if nominal.canvas:
        files.put(folder / ARTIFACTS["canvas"], nominal.canvas)
    files.put(folder / ARTIFACTS["output"], nominal.output.encode("utf-8", "replace"))


@dataclass(frozen=True)
class SubmissionInfo:
    """Whose submission it is, and what being late costs.

    Attributes:
        id, name: of the student, or the group.
        attempt: counts from 1.
        at: when, with its zone; None where it is not known.
        late_s, days, deducted: see `grader.exercise.policies.Late`; `deducted` are its points.
    """

    id: str
    name: str = ""
    attempt: int = 1
    at: datetime | None = None
    late_s: float = 0.0
    days: int = 0
    deducted: float = 0.0

    @classmethod
    def of(
        cls, id: str, name: str, attempt: int, at: datetime | None, policy: LatePolicy | None
    ) -> Self:
        """Make it by a policy for late submissions; None: there is none, or nothing is known.

        Raises:
            ValueError: the time has no zone.
        """
        late = Late() if policy is None else policy.deduction(at)
        return cls(id, name, attempt, at, late.late_s, late.days, late.points)

    def by(self, policy: LatePolicy | None) -> Self:
        """Return the same submission by the policy of another exercise, or of a changed one."""
        known = policy if self.at is not None or self.days else None
        return type(self).of(self.id, self.name, self.attempt, self.at, known)


@dataclass(frozen=True)
class Judging:
    """When and by what the recordings were judged; the same day as the runs, or later.

    Attributes:
        date: as `grader.recording.recording.now` writes it.
        grader: its version.
        exercise_sha256: see `grader.exercise.exercise.Exercise`.
    """

    date: str
    grader: str
    exercise_sha256: str


@dataclass(frozen=True)
class ResultProvenance:
    """When and by what a result was recorded and judged.

    Attributes:
        recorded: None where the recordings have no provenance.
    """

    judged: Judging
    recorded: Provenance | None = field(default=None, metadata=SPARSE)


@dataclass(frozen=True)
class RunSummary(Run):
    """A run in the result, with remarks on it among the flags.

    Attributes:
        start: where it started; None for the usual place.
    """

    start: Start | None = field(default=None, metadata=SPARSE)

    @classmethod
    def of(cls, recording: Recording, all_passed: bool = False) -> Self:
        """Summarise a recording; `all_passed`: whether it cost no points."""
        run = {field.name: getattr(recording.run, field.name) for field in fields(Run)}
        flags = (*recording.run.flags, *remarks(recording, all_passed))
        return cls(**{**run, "flags": flags}, start=recording.start)


@dataclass(frozen=True)
class NotShown:
    """The checks that a result for students leaves out.

    Attributes:
        checks: how many.
        max_score: of all of them [points].
        until_due: how many of them are shown when the exercise is over.
    """

    checks: int
    max_score: float
    until_due: int = 0


@dataclass(frozen=True)
class Result:
    """One judged run.

    Attributes:
        exercise, submission: their names.
        score, max_score: the points of all verdicts, earned and possible.
        verdicts: of each check that is worth points, in the exercise's order.
        run: the nominal run.
        varied_runs: those that start elsewhere.
        artifacts: what lies beside the result file: name -> relative path.
        provenance: how it was made; not compared.
        diagnosis: the earliest cause of lost points; None where none is lost, and in older files.
        handed_in: whose it is, and what being late costs; None where it is not known.
        not_shown: what it leaves out for students; None where it is whole.

        FILE, PAGE: the names of its file, and of the page beside that.
        ROUNDING: a total is rounded to hundredths, its parts need not be [points].
    """

    FILE: ClassVar = "result.json"
    PAGE: ClassVar = "report.html"
    ROUNDING: ClassVar = 0.01 + 1e-9

    exercise: str
    submission: str
    score: float
    max_score: float
    verdicts: tuple[Verdict, ...]
    run: RunSummary
    varied_runs: tuple[RunSummary, ...] = ()
    artifacts: Mapping[str, str] = field(default_factory=dict)
    provenance: ResultProvenance | None = field(default=None, compare=False, metadata=SPARSE)
    diagnosis: Diagnosis | None = field(default=None, metadata=SPARSE)
    handed_in: SubmissionInfo | None = field(default=None, metadata=SPARSE)
    not_shown: NotShown | None = field(default=None, metadata=SPARSE)

    @property
    def final(self) -> float:
        """The score less what being late costs [points]; never below 0."""
        deducted = 0.0 if self.handed_in is None else self.handed_in.deducted
        return max(round(self.score - deducted, 2), 0.0) if deducted else self.score

    def to_json(self) -> dict[str, Any]:
        """Return the result as its file has it."""
        data = json_file.with_phrases(self)
        names = (*IN_ORDER, "phrases")
        return {"schema": SCHEMA, **{name: data[name] for name in names if name in data}}

    @classmethod
    def from_json(cls, data: Any) -> Self:
        """Parse the result of a file that others may have changed.

        Raises:
            ValueError: it does not follow the schema, or does not add up.
        """
        json_file.validate(data, "result", SCHEMA)
        values = {name: data[name] for name in IN_ORDER if name in data}
        result = json_file.typed(cls, values, data.get("phrases"))
        names = [verdict.check for verdict in result.verdicts]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise ValueError(f"is damaged: it has two verdicts of the check {twice!r}")
        more = next((v for v in result.verdicts if v.score > v.max_score + Result.ROUNDING), None)
        if more is not None:
            raise ValueError(
                f"is damaged: it gives {more.score:g} of {more.max_score:g} points for the check "
                f"{more.check!r}"
            )
        for key in ("score", "max_score"):
            total, found = sum(getattr(v, key) for v in result.verdicts), getattr(result, key)
            if abs(total - found) > Result.ROUNDING:
                raise ValueError(
                    f"is damaged: its {key} is {found:g}, that of its verdicts {total:g}"
                )
        return result

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Self:
        """Read a result file.

        Raises:
            UsageError: it cannot be read or is no result of this version.
        """
        path = Path(path)
        return json_file.made(cls.from_json, path, json_file.read(path))

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the result file.

        Raises:
            UsageError: it cannot be written.
        """
        files.write(Path(path), json_file.text(self.to_json()))

    def put(self, folder: Path) -> None:
        """Write the result file into a folder for results; see `files.put`.

        Raises:
            UsageError: it cannot be written.
        """
        files.put(folder / self.FILE, json_file.text(self.to_json()).encode("utf-8"))


def build(
    submission: str,
    exercise: Exercise,
    recordings: Recordings,
    verdicts: Sequence[Verdict],
    diagnosis: Diagnosis | None = None,
) -> Result:
    """Put a result together, without artifacts."""
    seen = exercise.visible
    verdicts = [replace(each, visible=seen.get(each.check, "now")) for each in verdicts]
    # where students do not see all, no remark that they read may reveal that all passed
    all_passed = all(v.passed and v.visible in ("now", "points_only") for v in verdicts)
    judged = Judging(now(), system.grader_version(), exercise.sha256)
    nominal, *varied = (RunSummary.of(recording, all_passed) for recording in recordings)
    # conditions that it was not made with
    late = not_followed(recordings.nominal.provenance, exercise.conditions)
    return Result(
        exercise.name,
        submission,
        round(sum(verdict.score for verdict in verdicts), 2),
        round(sum(verdict.max_score for verdict in verdicts), 2),
        tuple(verdicts),
        replace(nominal, flags=(*nominal.flags, *late)),
        tuple(varied),
        provenance=ResultProvenance(judged, recordings.nominal.provenance),
        diagnosis=diagnosis,
    )
