"""The answer of the process that reads a submission: one line of JSON, strictly decoded."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from typing import Final, Self

from grader import strict_json
from grader.errors import GraderError, GraderFailure, SubmissionError, UsageError
from grader.message import NOTHING, Message
from grader.submission.set_ups import NotInspected
from grader.submission.start import Imports, Submission
from grader.text import clip

#: No line is longer.
MAX_BYTES: Final = 1_000_000
#: So many modules are in an answer, of those that are imported surely and of the others.
_MAX_MODULES: Final = 500
_MAX_NAME: Final = 200
#: So many notes are in an answer, and so much of each [characters].
_MAX_NOTES: Final = 20
_MAX_NOTE: Final = 1000

_REFUSALS: Final = {each.whose: each for each in (SubmissionError, UsageError)}


@dataclass(frozen=True)
class Answer:
    """The outcome of reading a submission; one of these.

    Attributes:
        found: what to start.
        asks: for an inspection.
        refused: why the submission cannot be used, and `whose` turn it is.
        unable: why the machine cannot read it, and the system's `errno` of that.
        failed: the grader's own mistake, in words.
    """

    found: Submission | None = None
    asks: NotInspected | None = None
    refused: Message = NOTHING
    whose: str = ""
    unable: str = ""
    errno: int | None = None
    failed: str = ""

    @classmethod
    def of_found(cls, submission: Submission) -> Self:
        """Answer with a submission, its lists and texts cut to their limits."""
        imports = Imports(_some(submission.imports.surely), _some(submission.imports.perhaps))
        notes = submission.notes[:_MAX_NOTES]
        short = tuple(note.map_texts(partial(clip, limit=_MAX_NOTE)) for note in notes)
        return cls(replace(submission, notes=short, imports=imports))

    @classmethod
    def of_refusal(cls, error: GraderError) -> Self:
        """Answer with the error that refuses a submission."""
        return cls(refused=error.message, whose=error.whose)

    def submission(self) -> Submission:
        """Return the submission that was found.

        Raises:
            SubmissionError, UsageError, OSError, NotInspected: that was the answer.
            GraderFailure: the copy has made a mistake.
        """
        if self.whose in _REFUSALS:
            raise _REFUSALS[self.whose](self.refused)
        if self.unable:
            raise OSError(self.errno, self.unable)
        if self.asks is not None:
            raise self.asks
        if self.found is None:
            failed = self.failed or "the answer makes no sense"
            raise GraderFailure(f"the submission could not be read: {failed[-4000:]}")
        return self.found


def decoded(line: bytes) -> Answer:
    """Decode an answer; one that makes no sense becomes that of a failure."""
    try:
        if len(line) > MAX_BYTES:
            raise ValueError(f"an answer of {len(line)} bytes")
        return strict_json.of_line(Answer, line)
    except (ValueError, RecursionError):
        return Answer()


def _some(modules: dict[str, str]) -> dict[str, str]:
    named = ((name, where) for name, where in modules.items() if len(name) <= _MAX_NAME)
    return dict(islice(named, _MAX_MODULES))
