"""Show a result in another format."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator
from pathlib import Path

from grader.cli import options
from grader.errors import UsageError
from grader.exercise.loading import load_exercise
from grader.exercise.result.result import ARTIFACTS, Result
from grader.exercise.result.visible import is_hidden
from grader.reports import formats
from grader.reports.report import Report
from grader.system import files
from grader.text.message import msg
from grader.text.translations import tr, translate


def add_arguments(parser: options.Parser) -> None:
    """Declare the verb's arguments."""
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.make_epilog = _formats
    parser.add_argument(
        "result",
        type=Path,
        nargs="+",
        metavar="RESULT.json",
        help=tr("a result, its folder, or what --error-json has written; several only with csv"),
    )
    parser.add_argument("--format", choices=formats.names(), default="terminal", metavar="NAME")
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help=tr("write there, not to standard output")
    )
    parser.add_argument(
        "--exercise",
        metavar="NAME",
        help=tr("which checks get 0 points for an error; autolab only"),
    )
    options.add_view(
        parser,
        tr("for teachers: also what the exercise hides from students; csv always is whole"),
    )
    parser.set_defaults(github_summary=False)
    if "markdown" in formats.names():
        parser.add_argument(
            "--github-summary",
            action="store_true",
            help=tr(
                "append the result as Markdown to $GITHUB_STEP_SUMMARY as well, as students see it"
            ),
        )


def main(args: argparse.Namespace) -> int:
    """Show the results; see `grader.cli` for the exit codes."""
    checks = _checks(args) if args.exercise else ()
    args.result = [path / Result.FILE if path.is_dir() else path for path in args.result]
    if args.out is not None:
        files.check_is_no_input(args.out, _read(args))
    shown = [formats.read(path, checks, options.view_of(args)) for path in args.result]
    summary = _summary_file() if args.github_summary else None
    if args.format == "terminal" and args.out is None and len(shown) == 1:
        from rich.console import Console

        from grader.reports import terminal

        (only,) = shown
        if isinstance(only, Report):
            terminal.show(only, Console())
        else:
            terminal.show_error(only, Console())
    else:
        content = formats.render(args.format, shown)
        if args.out is not None:
            files.write(args.out, content)
        else:
            _print(content)
    if summary is not None:
        whole = args.whole
        summed = [formats.read(path, checks, "student") for path in args.result] if whole else shown
        content = "".join(formats.render("markdown", [each]) for each in summed)
        with files.writing(summary), summary.open("a", encoding="utf-8") as file:
            file.write(content)
    return 0


def _formats() -> str:
    names = formats.names()
    width = max(map(len, names))
    lines = (f"  {name:{width}}  {translate(formats.load(name).summary)}" for name in names)
    return "\n".join((tr("formats:"), *lines))


def _checks(args: argparse.Namespace) -> tuple[str, ...]:
    """Return the names of the exercise's checks that the reader may see."""
    exercise = load_exercise(args.exercise)
    return tuple(
        name
        for name in exercise.points
        if args.whole or not is_hidden(exercise.visible.get(name, "now"), args.after_due)
    )


def _read(args: argparse.Namespace) -> Iterator[Path]:
    """Yield the files that a report is made of: the results, and the files beside them."""
    for path in options.inputs(args):
        yield path
        yield from (path.parent / name for name in ARTIFACTS.values())
        yield from (path.parent / ARTIFACTS["recording"]).rglob("*")


def _print(content: str) -> None:
    """Write to standard output as UTF-8, whatever the terminal's encoding."""
    try:
        sys.stdout.buffer.write(content.encode("utf-8"))
        sys.stdout.buffer.flush()
    except BrokenPipeError:  # the reader has closed it: `grader report ... | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _summary_file() -> Path:
    name = os.environ.get("GITHUB_STEP_SUMMARY")
    if not name:
        raise UsageError(
            msg(
                "--github-summary works in a step of GitHub Actions only: "
                "GITHUB_STEP_SUMMARY is not set"
            )
        )
    return Path(name)
