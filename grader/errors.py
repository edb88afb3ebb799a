"""The tree of errors: each has one text on what was found, and who has to act.

| error | whose | exit code |
|---|---|---|
| `UsageError`, `RecordingError` | call | 2 |
| `SubmissionError` | submission | 2 |
| `ExerciseError` | exercise | 2 |
| `CheckFailed` | exercise | 3 |
| `GraderFailure`, `NotNow`, `NotOffered`, `SceneFailure` | grader | 3 |
"""

from __future__ import annotations

from functools import partial
from typing import Any, ClassVar, Literal

from grader.text.message import Message, msg
from grader.text.strings import without_controls

#: Who has to act: the student, the exercise's author, the caller, the grader's maintainers.
Whose = Literal["submission", "exercise", "call", "grader"]


class GraderError(Exception):
    """Why there is no verdict.

    Args:
        message: a sentence, or its key where `values` are given; a text without them is no key.

    Attributes:
        message: what was found, what was expected, and what to do.
        whose: who has to act.
        exit_code: the command line's.
    """

    whose: ClassVar[Whose] = "grader"
    exit_code: ClassVar[int] = 3

    def __init__(self, message: str | Message, /, **values: Any) -> None:
        if isinstance(message, str) and values:
            message = msg(message, **values)
        self.message = Message.of(message)
        super().__init__(self.message)


class UsageError(GraderError):
    """The call cannot be carried out."""

    whose = "call"
    exit_code = 2


class SubmissionError(GraderError):
    """The submission cannot be used; its text has file names in it, and may go to terminals."""

    whose = "submission"
    exit_code = 2

    def __init__(self, message: str | Message, /, **values: Any) -> None:
        super().__init__(message, **values)
        self.message = self.message.map_texts(partial(without_controls, sign="?", keep="\n"))
        self.args = (self.message,)


class ExerciseError(GraderError):
    """The exercise cannot be used."""

    whose = "exercise"
    exit_code = 2


class CheckFailed(ExerciseError):
    """A check raised an exception; the submission can be judged after its repair."""

    exit_code = 3


class RecordingError(GraderError):
    """There is no recording that can be judged where one should be."""

    whose = "call"
    exit_code = 2


class GraderFailure(GraderError):
    """The grader itself failed; never the submission's fault."""


class NotNow(GraderFailure):
    """The system refused what it may allow the next time; see `grader.run.processes.refusal`."""


class SceneFailure(GraderFailure):
    """The scene beside a submission raised an exception, or returned what it must not."""


class NotOffered(GraderFailure):
    """This machine does not have the isolation level of a class."""
