"""Make the feedback for one student: as a page, as Markdown, in a sentence.

It is made from result.json, the picture and the node's output. The recording is left out: it
contains what an exercise may hide, and makes a page five times as long. Times and paths of the run
are left out too, so that equal results give equal bytes.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import PurePath

from grader import Recording
from grader.exercise import ErrorResult, View
from grader.reports import Artifacts, ErrorReport, Report, render
from grader.reports.wording import points
from grader.text import Message, msg, shown, tr, translate, translations
from grader_class.entry import Entry
from grader_class.gradebook.grade import LONGEST, Grade, out_of
from grader_class.page.thumb import Thumb
from grader_class.zipping import zipped

#: The time of a line in ROS's log; and an address in memory, in Python's format.
_LOGGED_AT, _ADDRESS = re.compile(r"\[\d{9,11}\.\d{9}\]"), re.compile(r"\b0x[0-9a-f]{8,16}\b")
#: The name of a page.
PAGE = "feedback.html"
#: The begin of each comment: it shows that the grader wrote a comment that comes back.
MARK = msg("Graded automatically:")


@dataclass(frozen=True)
class Feedback:
    """Makes the feedback in all formats.

    Attributes:
        view: who reads it: a student before, or after the exercise is due.
    """

    view: View = "student"

    def file(self, name: str, entry: Entry) -> bytes:
        """Return the feedback in the format of a file's name.

        A zip contains the page, HTML is the page, all else is text.
        """
        suffix = PurePath(name).suffix.lower()
        if suffix == ".zip":
            return zipped([(PAGE, self.page(entry))])
        return self.page(entry) if suffix in (".html", ".htm") else self.markdown(entry)

    def page(self, entry: Entry) -> bytes:
        return render("html", [self._report(entry)]).encode("utf-8")

    def markdown(self, entry: Entry) -> bytes:
        """Return the report as text, without the picture."""
        return render("markdown", [self._report(entry)]).encode("utf-8")

    def sentence(self, grade: Grade) -> str:
        """Return the points, and what to fix first, as plain text in one line."""
        entry, late = grade.entry, grade.late_deduction
        if grade.final is None:
            return ""
        values = {"mark": translate(MARK), "points": out_of(grade.final, entry.max_score)}
        values["first"] = self._first(entry)
        if late:
            sentence = tr(
                "{mark} {points} points ({score} less {late} for being late). {first}",
                score=points(grade.score or 0),
                late=points(late),
                **values,
            )
        else:
            sentence = tr("{mark} {points} points. {first}", **values)
        return shown(sentence, LONGEST)

    def _first(self, entry: Entry) -> str:
        if not has_feedback(entry):
            return translate(entry.message) or tr("Nothing was handed in.")
        report = self._report(entry)
        return report.message if isinstance(report, ErrorReport) else report.headline

    def _report(self, entry: Entry) -> Report | ErrorReport:
        if entry.result is None:
            error = ErrorResult("submission", entry.message, entry.max_score)
            return ErrorReport(error, entry.folder)
        result = entry.result
        # without what differs between equal runs
        run, *varied = (
            replace(run, wall_s=0.0, isolation="") for run in (result.run, *result.varied_runs)
        )
        result = replace(result, run=run, varied_runs=tuple(varied), provenance=None)
        return Report(result, _WithoutRecordings(result, entry.folder), self.view)


class _WithoutRecordings(Artifacts):
    """Picture and output alone, without recordings; of what has no picture, words."""

    @property
    def recordings(self) -> Mapping[int, Recording | Message]:
        return {}

    @property
    def solid_words(self) -> str:
        thumb = Thumb.read(self.folder)
        return "" if thumb is None else thumb.words

    @property
    def output(self) -> str:
        """The output without what differs in each run: times of log lines, addresses of objects."""
        return _ADDRESS.sub("0x...", _LOGGED_AT.sub("[...]", super().output))


def is_ours(comment: str) -> bool:
    """Whether the grader wrote a comment, in any language."""
    return any(translate(MARK, language) in comment for language in translations.LANGUAGES)


def has_feedback(entry: Entry) -> bool:
    """Whether there is feedback: something was handed in, and the grader has not failed."""
    return entry.state in ("judged", "unusable")
