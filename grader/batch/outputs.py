"""What is made of all entries of a class together, at the end of each call.

Nothing of it tells when or how fast anything was graded: the same entries give the same bytes.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from grader import files
from grader.batch.entry import Entry
from grader.batch.gradebook.write import CSV, Options
from grader.batch.gradebook.write import write as write_gradebook
from grader.batch.page import html
from grader.batch.similar import export, look
from grader.exercise.exercise import Exercise
from grader.language.telling import tell
from grader.result.visible import View

PAGE = "index.html"


def write(
    out: Path,
    entries: Sequence[Entry],
    exercise: Exercise,
    view: View = "student",
    assignment: str = "",
) -> list[str]:
    """Write gradebook and pages.

    Args:
        view: who reads the feedback: a student before, or after the exercise is over.
        assignment: what Canvas calls it.

    Returns:
        Notes, as sentences.

    Raises:
        UsageError: one of them cannot be written.
    """
    look.write(entries, exercise, out)
    links = {tell("Look at these together"): look.PAGE, tell("Gradebook"): CSV}
    files.put(out / PAGE, html.render(entries, exercise, links).encode("utf-8"))
    notes = write_gradebook(out, entries, Options(exercise.title, view, assignment))
    export.write(entries, exercise, out)
    return notes
