"""The formats of reports, and the error that each shows where there is no result.

A format is a `Format`, an entry point of the group `grader.reports`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from grader.errors import UsageError
from grader.exercise.result import json_file
from grader.exercise.result.json_file import ErrorResult
from grader.exercise.result.result import Result
from grader.exercise.result.visible import View
from grader.reports.report import Artifacts, Report
from grader.reports.wording import points
from grader.system import extensions
from grader.text import strings as text
from grader.text.message import Message, joined, msg
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
        self.message = text.clip(
            text.plain(translate(error.message)).strip(), _TEXT_LIMIT, keeps_end=True
        )
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


@dataclass(frozen=True)
class Format:
    """A format that `grader report --format` knows, by an entry point of `grader.reports`.

    Attributes:
        summary: its purpose, in a few words.
        render: renders a result.
        render_error: renders an error, where there is no result.
        render_all: renders several results and errors; None where a format shows one.
    """

    summary: Message
    render: Callable[[Report], str]
    render_error: Callable[[ErrorReport], str]
    render_all: Callable[[Sequence[Report | ErrorReport]], str] | None = None


def names() -> Sequence[str]:
    return tuple(extensions.points(extensions.REPORTS))


def load(name: str) -> Format:
    form: Format = extensions.load(extensions.REPORTS, name)
    return form


def read(path: Path, checks: Sequence[str] = (), view: View = "student") -> Report | ErrorReport:
    """Read a result file or an error file.

    Args:
        checks: the names of the exercise's checks, for errors; see `ErrorReport`.
        view: what of the result its reader may see.

    Raises:
        UsageError: the file cannot be read or is neither.
    """
    data = json_file.read(path)
    if isinstance(data, dict) and str(data.get("schema")).startswith(json_file.ERROR_FAMILY):
        failed = json_file.made(ErrorResult.from_json, path, data)
        return ErrorReport(failed, path.parent, checks, path)
    result = json_file.made(Result.from_json, path, data)
    return Report(result, Artifacts(result, path.parent), view)


def render(name: str, reports: Sequence[Report | ErrorReport]) -> str:
    """Render one or several results or errors in a format.

    Raises:
        UsageError: the format shows only one, or something that it needs is missing.
    """
    form = load(name)
    if form.render_all is not None:
        return form.render_all(reports)
    if len(reports) != 1:
        several = ", ".join(each for each in names() if load(each).render_all is not None)
        raise UsageError(
            "the format {name} shows one result, found {n}; several can be given with: {several}",
            name=name,
            n=len(reports),
            several=several,
        )
    (report,) = reports
    return form.render(report) if isinstance(report, Report) else form.render_error(report)
