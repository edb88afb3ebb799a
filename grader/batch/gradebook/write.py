"""All files of the gradebook, written into the folder of a class.

    gradebook.csv  gradebook.jsonl
    export/moodle-grading-worksheet.csv  export/moodle-grade-import.csv  export/moodle-feedback.zip
    export/canvas-gradebook.csv  export/canvas-feedback.zip
    export/feedback.zip     where neither of them can have its own
    export/notes.txt        what an import lacks

Which of them there are follows from what is known of the people. The same entries give the same
bytes, in each language.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from grader import files
from grader.batch.entry import Entry
from grader.batch.gradebook import archive, canvas, lines, moodle, table
from grader.batch.gradebook.feedback import Feedback, has_feedback
from grader.batch.gradebook.grade import Grade, grades
from grader.batch.gradebook.notes import notes
from grader.language.telling import told
from grader.result.visible import View

CSV, JSON_LINES, EXPORT = "gradebook.csv", "gradebook.jsonl", "export"
MOODLE_WORKSHEET, MOODLE_GRADES = "moodle-grading-worksheet.csv", "moodle-grade-import.csv"
CANVAS_GRADES, NOTES = "canvas-gradebook.csv", "notes.txt"
MOODLE_FEEDBACK, CANVAS_FEEDBACK = "moodle-feedback.zip", "canvas-feedback.zip"
FEEDBACK = "feedback.zip"


@dataclass(frozen=True)
class Options:
    """How a gradebook is written.

    Attributes:
        title: what the exercise is called.
        view: who reads the feedback: a student before, or after the exercise is over.
        assignment: what Canvas calls it: title, number, or both as in "Spiral (4711)"; '' for the
            exercise's title.
        nothing_is_zero: see `grader.batch.gradebook.grade.grades`.
    """

    title: str
    view: View = "student"
    assignment: str = ""
    nothing_is_zero: bool = True


def write(out: Path, entries: Sequence[Entry], options: Options) -> list[str]:
    """Write them; an export that there is no more goes.

    Returns:
        what an import lacks and who is left out, as sentences.

    Raises:
        UsageError: one of them cannot be written.
    """
    everybody = grades(entries, options.nothing_is_zero)
    feedback = Feedback(options.view)
    assignment = canvas.assignment_of(everybody, options.assignment or options.title)
    lacking = notes(everybody, assignment)
    files.clear(out / EXPORT)  # a link leads somewhere else
    texts = {
        f"{EXPORT}/{MOODLE_WORKSHEET}": moodle.worksheet(everybody, feedback),
        f"{EXPORT}/{MOODLE_GRADES}": moodle.grade_import(everybody, options.title, feedback),
        f"{EXPORT}/{CANVAS_GRADES}": canvas.gradebook(everybody, assignment),
        f"{EXPORT}/{NOTES}": "".join(f"{told(note)}\n" for note in lacking),
    }
    for name, content in texts.items():
        _put(out / name, content)
    files.put(out / CSV, table.render(everybody).encode("utf-8"))
    files.put(out / JSON_LINES, lines.render(everybody).encode("utf-8"))
    _put_feedback(out / EXPORT, everybody, feedback)
    return lacking


def _put_feedback(folder: Path, everybody: Sequence[Grade], feedback: Feedback) -> None:
    def page(name: str, grade: Grade) -> bytes:
        return feedback.page(grade.entry)

    def as_handed_in(name: str, grade: Grade) -> bytes:
        return canvas.feedback_file(name, grade, feedback)

    for_moodle, for_canvas = moodle.feedback_files(everybody), canvas.feedback_files(everybody)
    others = {} if for_moodle or for_canvas else _by_hand_in(everybody)
    _put_zip(folder / MOODLE_FEEDBACK, for_moodle, page)
    _put_zip(folder / CANVAS_FEEDBACK, for_canvas, as_handed_in)
    _put_zip(folder / FEEDBACK, others, page)


def _by_hand_in(everybody: Sequence[Grade]) -> dict[str, Grade]:
    return {f"{grade.entry.id}.html": grade for grade in everybody if has_feedback(grade.entry)}


def _put(path: Path, content: str) -> None:
    if content:
        files.put(path, content.encode("utf-8"))
    else:
        files.clear(path)


def _put_zip(
    path: Path, members: Mapping[str, Grade], content: Callable[[str, Grade], bytes]
) -> None:
    if members:
        archive.put(path, ((name, content(name, members[name])) for name in sorted(members)))
    else:
        files.clear(path)
