"""Run a submission, record what really happened, judge it, explain the verdict.

The names of `__all__` are public, and so is `grader.testing`; all else may change. They are loaded
at their first use: the processes of a run import parts of this package, and must not wait for what
only the grader's process needs.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from grader.errors import (
        ExerciseError,
        GraderError,
        GraderFailure,
        RecordingError,
        SubmissionError,
        UsageError,
    )
    from grader.exercise.check import Checks, Tolerances
    from grader.exercise.driven_path import DrivenPath
    from grader.exercise.exercise import Exercise
    from grader.exercise.loading import load_exercise
    from grader.exercise.verdict import Evidence, Expected, Finding, Verdict
    from grader.grading import grade, record
    from grader.judging import judge, load_recordings, save_recordings
    from grader.recording.recording import Recording, Recordings
    from grader.result.result import Result
    from grader.result.visible import student_view
    from grader.run.opening import open_submission

#: module -> its public names
_PUBLIC = {
    "grader.grading": ("grade", "record"),
    "grader.judging": ("judge", "load_recordings", "save_recordings"),
    "grader.run.opening": ("open_submission",),
    "grader.exercise.exercise": ("Exercise",),
    "grader.exercise.loading": ("load_exercise",),
    "grader.exercise.check": ("Checks", "Tolerances"),
    "grader.exercise.driven_path": ("DrivenPath",),
    "grader.exercise.verdict": ("Evidence", "Expected", "Finding", "Verdict"),
    "grader.recording.recording": ("Recording", "Recordings"),
    "grader.result.result": ("Result",),
    "grader.result.visible": ("student_view",),
    "grader.errors": (
        *("GraderError", "UsageError", "SubmissionError"),
        *("ExerciseError", "RecordingError", "GraderFailure"),
    ),
}
_MODULES = {name: module for module, names in _PUBLIC.items() for name in names}

__all__ = [
    "Checks",
    "DrivenPath",
    "Evidence",
    "Exercise",
    "ExerciseError",
    "Expected",
    "Finding",
    "GraderError",
    "GraderFailure",
    "Recording",
    "RecordingError",
    "Recordings",
    "Result",
    "SubmissionError",
    "Tolerances",
    "UsageError",
    "Verdict",
    "grade",
    "judge",
    "load_exercise",
    "load_recordings",
    "open_submission",
    "record",
    "save_recordings",
    "student_view",
]


def __getattr__(name: str) -> Any:
    """Load a public name at its first use."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(importlib.import_module(_MODULES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
