"""A result in many formats, one file each; a report knows verdicts, not checks.

A format is a module with `render(report: Report) -> str`; one that can hold several results has
`render_all(reports: Sequence[Report]) -> str` as well. `FORMATS` lists them all.
"""

from __future__ import annotations

import contextlib
import importlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from grader.errors import UsageError
from grader.reports.report import Report

__all__ = ["FORMATS", "Format", "Report", "render", "write"]


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
    "terminal": Format("terminal", "for reading in a terminal"),
    "html": Format("page.html", "one self-contained page: picture, plots, animation, verdicts"),
    "markdown": Format("markdown", "a GitHub step summary, a comment, a release's text"),
    "csv": Format("csv", "one row a result, for a spreadsheet", takes_several=True),
    "junit": Format("junit", "JUnit XML for GitLab, Jenkins and GitHub actions"),
    "gradescope": Format("gradescope", "Gradescope's results.json"),
    "classroom50": Format("classroom50", "Classroom 50's result.json"),
    "prairielearn": Format("prairielearn", "PrairieLearn's results.json"),
    "autolab": Format("autolab", "the last two lines of an Autolab autograder's output"),
    "moodle-vpl": Format("moodle_vpl", "Moodle's Virtual Programming Lab"),
    "github-autograding": Format("github_autograding", "GitHub Classroom's old reporter"),
}


def render(name: str, reports: Sequence[Report]) -> str:
    """One or several results in a format.

    Raises:
        UsageError: the format shows one result and there are more, or it lacks something.
    """
    form = FORMATS[name]
    if form.takes_several:
        return str(form.load().render_all(reports))
    if len(reports) != 1:
        several = ", ".join(n for n, f in FORMATS.items() if f.takes_several)
        raise UsageError(
            f"the format {name} shows one result, found {len(reports)}; several can be given "
            f"with: {several}"
        )
    return str(form.load().render(reports[0]))


def write(content: str, path: Path) -> None:
    """Write a report whole or not at all.

    Raises:
        UsageError: the file cannot be written.
    """
    unfinished = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished.write_text(content, encoding="utf-8", newline="")
        unfinished.replace(path)
    except OSError as error:
        with contextlib.suppress(OSError):
            unfinished.unlink(missing_ok=True)
        raise UsageError(f"cannot write {path}: {error.strerror}") from None
