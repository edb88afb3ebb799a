"""Run a submission and judge it."""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Iterable
from pathlib import Path

from rich.console import Console

from grader import files
from grader.cli import error_file, progress
from grader.errors import GraderError
from grader.exercise.check import judge
from grader.exercise.loading import DEFAULT, load_exercise
from grader.grading import RUNNERS, interfaces_for, run_all
from grader.recording import folder
from grader.recording.recording import Recordings
from grader.reports import Report, render, terminal
from grader.requirements import require
from grader.result.result import FAMILY, build
from grader.run import zygotes
from grader.submission.opening import open_submission

#: What lies beside a result file: name -> path relative to it.
ARTIFACTS = {"canvas": "canvas.png", "recording": "recording", "output": "output.txt"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("submission", type=Path, help="a .py file, a folder, a package or a zip")
    parser.add_argument(
        "--exercise",
        default=DEFAULT,
        metavar="NAME|FOLDER|FILE",
        help="an installed one, the folder of another, or an edited exercise.yaml",
    )
    parser.add_argument(
        "--time",
        choices=sorted(RUNNERS),
        default="virtual",
        help="the clock that the submission lives by; virtual takes seconds and is the default",
    )
    parser.add_argument(
        "--seed", type=int, metavar="N", help="where the varied runs start (the exercise's own)"
    )
    parser.add_argument("--watch", action="store_true", help="grade again on every save")
    parser.add_argument("--out", type=Path, metavar="DIR", help="default: below graded/")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the result here as well")
    parser.add_argument("--executable", metavar="NAME", help="which console script to start")
    parser.add_argument(
        "--fail-under", type=points, metavar="POINTS", help="exit 1 below this score"
    )


def points(text: str) -> float:
    """A number of points from the command line."""
    value = float(text)
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"expected a number of points, found {text}")
    return value


def main(args: argparse.Namespace) -> int:
    """Grade one submission; see `grader.cli` for the exit codes."""
    if args.time == "virtual":
        zygotes.warm()  # they import while we do something else
    require("rosbags")  # now, not when a run is to be saved
    if not args.watch:
        return _grade(args)
    require("watchdog")
    from grader.cli.watch import each_save

    for _ in each_save(args.submission):
        _grade_and_go_on(args)
    return 0


def _grade_and_go_on(args: argparse.Namespace) -> None:
    """Grade; what cannot be used now may be usable after the next save."""
    messages = Console(stderr=True, highlight=False)
    error_file.prepare(args)
    try:
        _grade(args)
    except GraderError as error:
        messages.print(error.message, markup=False, soft_wrap=True)
        error_file.write(error, args)
    messages.print("Waiting for the next save; Ctrl-C ends.", style="dim")


def _grade(args: argparse.Namespace) -> int:
    exercise = load_exercise(args.exercise)
    out: Path = args.out or _default_out(args.submission)
    console, messages = Console(), Console(stderr=True, highlight=False)
    with open_submission(args.submission, args.executable) as submission:
        messages.print(f"Found: {submission.found}", markup=False, soft_wrap=True)
        interfaces_for(submission, exercise)  # refuses, if at all, before anything is written
        _prepare(out, args.json, error_file.inputs(args))
        messages.print(f"Running it beside a simulator, in {args.time} time ...")
        with progress.shown(messages, "running") as show:
            recordings = run_all(
                submission, exercise, RUNNERS[args.time], seed=args.seed, progress=show
            )
        name = submission.name
    verdicts = judge(recordings, exercise.checks, exercise.points, exercise.tolerances)
    artifacts = _write(recordings, out)
    result = build(name, exercise, recordings, verdicts, artifacts)
    report = Report.of(result, out, recordings)
    result.write(out / "result.json")
    if args.json:
        result.write(args.json)
    page = out / "report.html"
    files.write(page, render("html", [report]))
    terminal.show(report, console)
    console.print(f"The page with picture and plots: {page}", highlight=False, soft_wrap=True)
    return int(args.fail_under is not None and result.score < args.fail_under)


def _default_out(submission: Path) -> Path:
    """A folder of its own for each submission: alice/turtle_controller.py is not bob's."""
    absolute = Path(os.path.abspath(submission))  # noqa: PTH100  a link keeps its own name
    here = Path.cwd()
    if absolute.is_relative_to(here) and absolute != here:
        return Path("graded") / absolute.relative_to(here)
    return Path("graded") / absolute.parent.name / absolute.name


def _prepare(out: Path, copy: Path | None, inputs: Iterable[Path]) -> None:
    """Find out before the run whether its result can be written, then make the folders.

    An older result goes now: it must not outlive a run that fails.

    Raises:
        UsageError: one of the places cannot be written; nothing has changed then.
    """
    written = [out / "result.json", *([copy] if copy else [])]
    read = list(inputs)
    for path in written:
        files.check_writable(path)
        files.check_replaceable(path, FAMILY, read)
    for path in written:
        files.make_folder(path.parent)
    for path in written:
        files.withdraw(path)


def _write(recordings: Recordings, out: Path) -> dict[str, str]:
    """Write everything but the result; name -> path relative to it."""
    folder.save_all(recordings, out / ARTIFACTS["recording"])
    (out / ARTIFACTS["canvas"]).write_bytes(recordings.nominal.png["window"])
    (out / ARTIFACTS["output"]).write_text(recordings.nominal.output, encoding="utf-8")
    return dict(ARTIFACTS)
