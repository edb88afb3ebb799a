"""Run a submission and judge it."""

from __future__ import annotations

import argparse
from pathlib import Path

from PIL import Image
from rich.console import Console

from grader import exercise as exercises
from grader import result as results
from grader.check import judge
from grader.reports import terminal
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
    console = Console()
    progress = Console(stderr=True, highlight=False)
    out: Path = args.out or Path("graded") / args.submission.resolve().stem
    with opened(args.submission, args.executable) as submission:
        progress.print(f"Found: {submission.found}", markup=False)
        progress.print("Running it beside a simulator, in real time: this takes about a minute.")
        # An older result must not outlive a run that fails.
        (out / "result.json").unlink(missing_ok=True)
        with progress.status("starting the simulator ...") as status:
            recording = real_time.run(
                submission,
                exercise.limits,
                lambda seconds: status.update(f"{seconds:.0f} s simulated"),
            )
        verdicts = judge(recording, exercise.checks, exercise.points, exercise.tolerances)
        name = submission.name
    recording.save(out / "recording")
    Image.fromarray(recording.window).save(out / "canvas.png")
    (out / "output.txt").write_text(recording.output, encoding="utf-8")
    artifacts = {"canvas": "canvas.png", "recording": "recording", "output": "output.txt"}
    result = results.build(name, exercise, recording, verdicts, artifacts)
    results.write(result, out / "result.json")
    if args.json:
        results.write(result, args.json)
    terminal.show(result, console)
    console.print(f"Picture, recording and result: {out}", highlight=False, soft_wrap=True)
    return int(args.fail_under is not None and result["score"] < args.fail_under)
