"""The input of every format where there is no result: an error, and who has to act."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from grader.exercise.result.json_file import ErrorResult
from grader.reports.wording import points
from grader.text import strings as text
from grader.text.message import joined, msg
from grader.text.translations import tr, translate

_TEXT_LIMIT: Final = 4000
_NOT_YOURS: Final = msg(
    "This is not your fault, and it says nothing about your work. Please tell the course staff: "
    "they have to grade it again."
)
_WHAT: Final = {
    "exercise": msg("The exercise cannot be used."),
    "call": msg("The grader was not called as it should be."),
    "grader": msg("The grader failed."),
}


class ErrorReport:
    """An error to show. Its texts are plain, as those of a `Report`.

    A submission that cannot be used earns 0 points. After any other error nothing is judged: there
    is no score then, and a format must not show one, not even 0.

    Args:
        error: the error.
        folder: of its file.
        checks: the names of the exercise's checks, for formats that have a score for each.
        file: the error file; None where there is none.

    Attributes:
        is_judged: whether the student has to act, so that the score is 0.
        message: found, expected, and what to do; may have several lines.
        max_score: the exercise's points; None where they are not known.
        made: when this report was made, in UTC.
        folder, checks, file: as above.
    """

    def __init__(
        self,
        error: ErrorResult,
        folder: Path,
        checks: Sequence[str] = (),
        file: Path | None = None,
    ) -> None:
        self.is_judged = error.whose == "submission"
        self.whose = error.whose
        self.made = datetime.now(UTC)
        self.message = text.clip_middle(text.plain(translate(error.message)).strip(), _TEXT_LIMIT)
        self.max_score = None if error.max_score is None else float(error.max_score)
        self.folder = folder
        self.checks = tuple(checks)
        self.file = file

    @property
    def name(self) -> str:
        """The name of the submission in a class: alice for alice.json and alice/error.json."""
        if (file := self.file) is None:
            return ""
        return text.shown(file.parent.name if file.stem == "error" else file.stem)

    @property
    def state(self) -> str:
        """The state in English, for tables."""
        return "cannot be graded" if self.is_judged else "not graded"

    @property
    def title(self) -> str:
        return tr("Cannot be graded") if self.is_judged else tr("Not graded")

    @property
    def score_text(self) -> str:
        """The points: '0 of 100'."""
        if self.max_score is None:
            return "0"
        return tr("{score} of {max_score}", score="0", max_score=points(self.max_score))

    @property
    def before(self) -> str:
        if self.is_judged:
            return tr("This cannot be graded, so it has no points:")
        return translate(joined([_WHAT[self.whose], _NOT_YOURS], " "))

    @property
    def after(self) -> str:
        """The sentence after the message; may be ''."""
        return tr("Mend that, and hand in again.") if self.is_judged else ""

    @property
    def paragraphs(self) -> list[str]:
        """All of it, for formats that show plain text."""
        return [part for part in (self.before, self.message, self.after) if part]
