"""The verdicts for a terminal; the first line is the first thing to fix."""

from __future__ import annotations

import io
import os
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import groupby
from pathlib import Path
from typing import Final

from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from grader.exercise.verdict import Verdict
from grader.reports import wording
from grader.reports.formats import ErrorReport, Format
from grader.reports.report import Report
from grader.reports.wording import score_text, title_of, word
from grader.text.message import msg
from grader.text.strings import for_terminal
from grader.text.translations import tr, translate

_MARKS = {
    "passed": ("✓", "green"),
    "failed": ("✗", "red"),
    "not_judged": ("–", "yellow"),
}


def render(report: Report) -> str:
    """Return the report as plain text, for a file."""
    return _captured(lambda console: show(report, console))


def render_error(report: ErrorReport) -> str:
    return _captured(lambda console: show_error(report, console))


def show_error(report: ErrorReport, console: Console) -> None:
    console.print(_text(tr("{title}.", title=report.title), "bold"), soft_wrap=True)
    for part in report.paragraphs:
        console.print()
        console.print(_text(part), soft_wrap=True)
    if report.is_judged:
        console.print()
        console.print(_score(report))


def _captured(print_to: Callable[[Console], None]) -> str:
    out = io.StringIO()
    width = shutil.get_terminal_size((100, 24)).columns
    print_to(Console(file=out, width=width, color_system=None, force_terminal=False))
    return out.getvalue()


def show(report: Report, console: Console) -> None:
    """Print the report; the first thing to fix is wrapped at words in a terminal."""
    whole = not console.is_terminal
    console.print(_text(report.first_line, "bold"), soft_wrap=whole)
    for line in report.advice:
        console.print(_text(line), soft_wrap=whole)
    console.print()
    head = tr("{submission}: {exercise}", submission=report.submission, exercise=report.exercise)
    console.print(_text(head, "bold"), soft_wrap=True)
    _checks(report, console)
    lost = (v for v in report.verdicts if not v.passed and not report.waited_for(v))
    for _, alike in groupby(lost, lambda v: (v.rationale, report.help_for(v), v.evidence)):
        console.print(_explanation(report, list(alike)))
    console.print()
    console.print(_text(wording.how_it_ran(report.run, wording.outcome_text(report.outcome(0)))))
    for flag in report.flags:
        console.print(_text(tr("Note: {flag}", flag=flag)))
    for note in report.notes:
        console.print(_text(note))
    console.print(_score(report))


def _score(report: Report | ErrorReport) -> Text:
    return _text(tr("Score: {score}", score=report.score_text), "bold")


def show_first(report: Report, write: Callable[[], Path | None]) -> None:
    """Print the report of a new result, write its files, and print where its page is.

    Args:
        write: writes them; returns the page, if there is one.
    """
    console = _PatientConsole()
    with console.without_reader():
        show(report, console)
        console.file.flush()
    page = write()
    with console.without_reader():
        if page is not None:
            where = _text(tr("The page with picture and plots: {page}", page=page))
            console.print(where, highlight=False, soft_wrap=True)


class _PatientConsole(Console):
    """A console that survives the end of its reader, such as `| head -1`."""

    @contextmanager
    def without_reader(self) -> Iterator[None]:
        """Go on where the reader is gone."""
        try:
            yield
        except BrokenPipeError:  # rich before 13.8 leaves it to us
            self.on_broken_pipe()

    def on_broken_pipe(self) -> None:
        """Print nothing more: the exit code depends on the score, not on the reader."""
        self.quiet = True
        with Path(os.devnull).open("wb") as nowhere:
            os.dup2(nowhere.fileno(), sys.stdout.fileno())


def _text(value: str, style: str = "") -> Text:
    return Text(for_terminal(value), style)


def _checks(report: Report, console: Console) -> None:
    """Print a line for each judged check, and one for all that wait for the same checks."""
    judged = [verdict for verdict in report.verdicts if not report.waited_for(verdict)]
    if judged:
        console.print(_table(report, judged, console.width))
    sign, color = _MARKS["not_judged"]
    for titles, verdicts in report.waiting.items():
        since, *more = (tr("“{title}”", title=title) for title in titles)
        for title in more:
            since = tr("{those} and {last}", those=since, last=title)
        waiting = tr(
            "not judged, since {titles} did not pass: {names} ({worth} points)",
            "not judged, since {titles} did not pass: {names} ({worth} points)",
            n=len(titles),
            titles=since,
            names=", ".join(verdict.check for verdict in verdicts),
            worth=wording.points(sum(verdict.max_score for verdict in verdicts)),
        )
        grid = Table.grid(padding=(0, 1))
        grid.add_row(Text(f" {sign}", color), _text(waiting, color))
        console.print(grid)


def _table(report: Report, verdicts: Sequence[Verdict], width: int) -> Table:
    """Return a table with names and notes beside the titles, or without them for lack of room.

    If there is no room for the titles either, the notes follow them and lines are wrapped.
    """
    rows = [_row(verdict, report.seen_by_students(verdict)) for verdict in verdicts]
    widest = [max(cell.cell_len for cell in column) for column in zip(*rows, strict=True)]
    beside = sum(widest) + 2 * len(widest) <= width
    alone = not beside and sum(widest[:-1]) + 2 * len(widest[:-1]) <= width
    table = Table.grid(padding=(0, 2))
    table.add_column(no_wrap=True)
    table.add_column(no_wrap=True, justify="right")
    for status, score, title, notes in rows:
        behind = Text.assemble(title, " (", notes, ")") if notes and not alone else title
        cells = [title, notes] if beside else [behind]
        table.add_row(status, score, *cells)
    return table


def _row(verdict: Verdict, seen: str) -> tuple[Text, Text, Text, Text]:
    sign, color = _MARKS[verdict.status]
    notes = [_text(verdict.check, "dim")] if verdict.title else []
    if verdict.is_partial:
        notes.append(_text(tr("partial credit"), "yellow"))
    if seen:
        notes.append(_text(seen, "dim"))
    return (
        Text(f" {sign} {word(verdict)}", color),
        _text(score_text(verdict)),
        _text(title_of(verdict), "bold"),
        Text(", ").join(notes),
    )


def _explanation(report: Report, alike: Sequence[Verdict]) -> Group:
    """Return the headings of verdicts that say the same, and once what they say."""
    lines: list[RenderableType] = [Text()]
    for verdict in alike:
        sign, color = _MARKS[verdict.status]
        values = {"title": title_of(verdict), "score": score_text(verdict)}
        if verdict.is_partial:
            head = tr("{title}: {score} (partial credit)", **values)
        else:
            head = tr("{title}: {score}", **values)
        lines.append(_text(f"{sign} {head}", f"bold {color}"))
    verdict = alike[0]
    lines.append(Padding(_text(" ".join(translate(verdict.rationale).split())), (0, 0, 0, 2)))
    lines += [_indented("•", str(point)) for point in report.points_of(verdict)]
    if help_ := report.help_for(verdict):
        lines.append(_indented("→", " ".join(help_.split()), "italic"))
    return Group(*lines)


def _indented(sign: str, value: str, style: str = "") -> Padding:
    grid = Table.grid(padding=(0, 1))
    grid.add_row(sign, _text(value, style))
    return Padding(grid, (0, 0, 0, 2))


FORMAT: Final = Format(msg("for reading in a terminal"), render, render_error)
