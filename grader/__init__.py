"""Run a submission, record what really happened, judge it, explain the verdict.

The names of `__all__` are public, and so is `grader.testing`; all else may change. They are loaded
at their first use: the processes of a run import parts of this package, and must not wait for what
only the grader's process needs.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # where type checkers find what `__getattr__` loads
    from grader.errors import ExerciseError as ExerciseError
    from grader.errors import GraderError as GraderError
    from grader.errors import GraderFailure as GraderFailure
    from grader.errors import RecordingError as RecordingError
    from grader.errors import SubmissionError as SubmissionError
    from grader.errors import UsageError as UsageError
    from grader.exercise.check import Checks as Checks
    from grader.exercise.check import Tolerances as Tolerances
    from grader.exercise.driven_path import DrivenPath as DrivenPath
    from grader.exercise.exercise import Exercise as Exercise
    from grader.exercise.loading import load_exercise as load_exercise
    from grader.exercise.result.result import Result as Result
    from grader.exercise.result.visible import student_view as student_view
    from grader.exercise.verdict import Evidence as Evidence
    from grader.exercise.verdict import Expected as Expected
    from grader.exercise.verdict import Finding as Finding
    from grader.exercise.verdict import Verdict as Verdict
    from grader.grading import grade as grade
    from grader.grading import record as record
    from grader.judging import judge as judge
    from grader.judging import load_recordings as load_recordings
    from grader.judging import save_recordings as save_recordings
    from grader.recording.recording import Recording as Recording
    from grader.recording.recording import Recordings as Recordings
    from grader.run.opening import open_submission as open_submission

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
    "grader.exercise.result.result": ("Result",),
    "grader.exercise.result.visible": ("student_view",),
    "grader.errors": (
        *("GraderError", "UsageError", "SubmissionError"),
        *("ExerciseError", "RecordingError", "GraderFailure"),
    ),
}
_MODULES = {name: module for module, names in _PUBLIC.items() for name in names}

__all__ = list(_MODULES)


def __getattr__(name: str) -> Any:
    """Load a public name at its first use."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(importlib.import_module(_MODULES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
