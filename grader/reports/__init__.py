"""A result in many formats, one file each; a report knows verdicts, not checks.

A format is a module with `render(report: Report) -> str`, and `render_error(report: ErrorReport)`
for where there is no result; one that can hold several has `render_all(reports)` as well. `FORMATS`
lists them all.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from grader.errors import UsageError
from grader.language.phrase import say
from grader.reports.beside import Beside
from grader.reports.error_report import ErrorReport
from grader.reports.report import Report
from grader.result import error, json_file
from grader.result.error import ErrorResult
from grader.result.result import Result
from grader.result.visible import View

__all__ = ["FORMATS", "ErrorReport", "Format", "Report", "read", "render"]


@dataclass(frozen=True)
class Format:
    """A format that `grader report --format` knows.

    Attributes:
        module: its module in this package, imported only when it is used.
        summary: what it is for, in a few words.
        takes_several: whether it can show several results at once.
    """

    module: str
    summary: str
    takes_several: bool = False

    def load(self) -> Any:
        """The module."""
        return importlib.import_module(f"{__name__}.{self.module}")


FORMATS: Final[Mapping[str, Format]] = {
    "terminal": Format("terminal", say("for reading in a terminal")),
    "html": Format(
        "page.html", say("one self-contained page: picture, plots, animation, verdicts")
    ),
    "markdown": Format("markdown", say("a GitHub step summary, a comment, a release's text")),
    "csv": Format("csv", say("one row a result, for a teacher's spreadsheet"), takes_several=True),
    "junit": Format("junit", say("JUnit XML for GitLab, Jenkins and GitHub actions")),
    "gradescope": Format("gradescope", say("Gradescope's results.json")),
    "classroom50": Format("classroom50", say("Classroom 50's result.json")),
    "prairielearn": Format("prairielearn", say("PrairieLearn's results.json")),
    "autolab": Format("autolab", say("the last two lines of an Autolab autograder's output")),
    "moodle-vpl": Format("moodle_vpl", say("Moodle's Virtual Programming Lab")),
    "github-autograding": Format("github_autograding", say("GitHub Classroom's old reporter")),
}


def read(path: Path, checks: Sequence[str] = (), view: View = "student") -> Report | ErrorReport:
    """Read a result file or an error file.

    Args:
        checks: the names of the exercise's checks, for errors; see `ErrorReport`.
        view: who looks.

    Raises:
        UsageError: it cannot be read or is neither.
    """
    data = json_file.read(path)
    if isinstance(data, dict) and str(data.get("schema")).startswith(error.FAMILY):
        made = json_file.made(ErrorResult.from_json, path, data)
        return ErrorReport(made, path.parent, checks, path)
    result = json_file.made(Result.from_file, path, data)
    return Report(result, Beside(result, path.parent), view)


def render(name: str, reports: Sequence[Report | ErrorReport]) -> str:
    """One or several results or errors in a format.

    Raises:
        UsageError: the format shows one and there are more, or it lacks something.
    """
    form = FORMATS[name]
    if form.takes_several:
        return str(form.load().render_all(reports))
    if len(reports) != 1:
        several = ", ".join(n for n, f in FORMATS.items() if f.takes_several)
        raise UsageError(
            say(
                "the format {name} shows one result, found {n}; several can be given with: "
                "{several}",
                name=name,
                n=len(reports),
                several=several,
            )
        )
    (report,) = reports
    module = form.load()
    return str(module.render(report) if isinstance(report, Report) else module.render_error(report))
