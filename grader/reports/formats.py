"""The formats of reports: each a `Format`, an entry point of the group `grader.reports`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from grader.errors import UsageError
from grader.exercise.result import json_file
from grader.exercise.result.json_file import ErrorResult
from grader.exercise.result.result import Result
from grader.exercise.result.visible import View
from grader.reports.error_report import ErrorReport
from grader.reports.report import Artifacts, Report
from grader.system import extensions
from grader.text.message import Message


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
