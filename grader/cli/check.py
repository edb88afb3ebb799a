"""Judge a saved recording again."""

from __future__ import annotations

import argparse
from pathlib import Path

from rich.console import Console

from grader import exercise as exercises
from grader import result as results
from grader.check import judge
from grader.recording import load_all
from grader.reports import terminal


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("recording", type=Path, help="the folder `recording` of a graded run")
    parser.add_argument("--exercise", default=exercises.DEFAULT, metavar="NAME")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the result here")
    parser.add_argument(
        "--fail-under", type=float, metavar="POINTS", help="exit 1 below this score"
    )


def main(args: argparse.Namespace) -> int:
    """Judge without running anything; see `grader.cli` for the exit codes."""
    exercise = exercises.load(args.exercise)
    recordings = load_all(args.recording)
    verdicts = judge(recordings, exercise.checks, exercise.points, exercise.tolerances)
    result = results.build(args.recording.name, exercise, recordings, verdicts, {})
    if args.json:
        results.write(result, args.json)
    terminal.show(result, Console())
    return int(args.fail_under is not None and result["score"] < args.fail_under)
