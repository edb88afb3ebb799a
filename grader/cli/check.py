"""Judge a saved recording again."""

from __future__ import annotations

import argparse
import os
from dataclasses import replace
from pathlib import Path

from rich.console import Console

from grader import files, grading
from grader.cli import error_file
from grader.cli.run import points
from grader.exercise import DEFAULT
from grader.exercise.loading import load_exercise
from grader.recording.folder import WINDOW_PICTURE, load_all
from grader.reports import Report, terminal
from grader.result.result import FAMILY


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("recording", type=Path, help="the folder `recording` of a graded run")
    parser.add_argument(
        "--exercise",
        default=DEFAULT,
        metavar="NAME|FOLDER|FILE",
        help="an installed one, the folder of another, or an edited exercise.yaml",
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the result here")
    parser.add_argument(
        "--fail-under", type=points, metavar="POINTS", help="exit 1 below this score"
    )


def main(args: argparse.Namespace) -> int:
    """Judge without running anything; see `grader.cli` for the exit codes."""
    if args.json:
        files.check_writable(args.json)
        files.check_replaceable(args.json, FAMILY, error_file.inputs(args))
    exercise = load_exercise(args.exercise)
    folder: Path = args.recording
    if (folder / "recording").is_dir():  # the folder of the result, which holds the recording
        folder /= "recording"
    recordings = load_all(folder)
    result = grading.judge(recordings, exercise, submission=args.recording.name)
    if args.json:
        beside = os.path.relpath(folder, args.json.parent)
        artifacts = {"recording": beside, "canvas": f"{beside}/{WINDOW_PICTURE}"}
        result = replace(result, artifacts=artifacts)
        result.write(args.json)
    terminal.show(Report.of(result, folder, recordings), Console())
    return int(args.fail_under is not None and result.score < args.fail_under)
