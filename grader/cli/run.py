"""Run a submission and judge it."""

from __future__ import annotations

import argparse
from pathlib import Path

from PIL import Image
from rich.console import Console

from grader import exercise as exercises
from grader import result as results
from grader.check import judge
from grader.cli import progress
from grader.errors import UsageError
from grader.recording import Recordings
from grader.reports import terminal
from grader.result import Result
from grader.run import real_time
from grader.submission import opened


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("submission", type=Path, help="a .py file, a folder, a package or a zip")
    parser.add_argument("--exercise", default=exercises.DEFAULT, metavar="NAME")
    parser.add_argument(
        "--time", choices=["real"], default="real", help="the clock that the submission lives by"
    )
    parser.add_argument("--out", type=Path, metavar="DIR", help="default: graded/SUBMISSION")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the result here as well")
    parser.add_argument("--executable", metavar="NAME", help="which console script to start")
    parser.add_argument(
        "--fail-under", type=float, metavar="POINTS", help="exit 1 below this score"
    )


def main(args: argparse.Namespace) -> int:
    """Grade one submission; see `grader.cli` for the exit codes."""
    exercise = exercises.load(args.exercise)
    out: Path = args.out or Path("graded") / args.submission.resolve().stem
    console, messages = Console(), Console(stderr=True, highlight=False)
    with opened(args.submission, args.executable) as submission:
        messages.print(f"Found: {submission.found}", markup=False, soft_wrap=True)
        _prepare(out, args.json)
        messages.print("Running it beside a simulator, in real time; this can take a minute.")
        with progress.shown(messages, "running") as show:
            recordings = Recordings(real_time.run(submission, exercise.limits, show))
        name = submission.name
    verdicts = judge(recordings, exercise.checks, exercise.points, exercise.tolerances)
    artifacts = _write(recordings, out)
    result = results.build(name, exercise, recordings, verdicts, artifacts)
    _write_result(result, out, args.json)
    terminal.show(result, console)
    console.print(f"Picture, recording and result: {out}", highlight=False, soft_wrap=True)
    return int(args.fail_under is not None and result["score"] < args.fail_under)


def _prepare(out: Path, copy: Path | None) -> None:
    """Find out before the run whether its result can be written.

    An older result goes now: it must not outlive a run that fails.

    Raises:
        UsageError: one of the places cannot be written.
    """
    for folder in (out, *([copy.parent] if copy else [])):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            probe = folder / ".grader-can-write"
            probe.touch()
            probe.unlink()
        except OSError as error:
            raise UsageError(f"cannot write into {folder}: {error.strerror}") from None
    for path in (out / "result.json", *([copy] if copy else [])):
        if path.is_dir():
            raise UsageError(f"{path} is a folder; expected the name of a file to write")
        path.unlink(missing_ok=True)


def _write(recordings: Recordings, out: Path) -> dict[str, str]:
    """Write everything but the result; name -> path relative to it."""
    recordings.save(out / "recording")
    Image.fromarray(recordings.nominal.window).save(out / "canvas.png")
    (out / "output.txt").write_text(recordings.nominal.output, encoding="utf-8")
    return {"canvas": "canvas.png", "recording": "recording", "output": "output.txt"}


def _write_result(result: Result, out: Path, copy: Path | None) -> None:
    results.write(result, out / "result.json")
    if copy:
        results.write(result, copy)
