"""Try an exercise on its right solutions and mutants: who catches what, and what is to mend."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.table import Table

from grader.errors import UsageError
from grader.exercise.loading import load_exercise
from grader.testing.checking import Progress, check_exercise
from grader.testing.examination import Examination


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.epilog = "Exit code: 0 all is fine, 1 there is something to mend, 2 it cannot be used."
    parser.add_argument("exercise", metavar="NAME|FOLDER", help="an installed one, or a folder")
    parser.add_argument(
        "--mutants", type=Path, metavar="FILE", help="the solutions (mutants.yaml in its folder)"
    )
    parser.add_argument("--jobs", type=_jobs, metavar="N", help="so many at once (one a core)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all of it here")
    parser.add_argument("--markdown", type=Path, metavar="FILE", help="write the table here")


def _jobs(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"expected a number from 1, found {text}")
    return number


def main(args: argparse.Namespace) -> int:
    """Try it; 1 if there is something to mend. See `grader.cli` for the other exit codes."""
    exercise = load_exercise(args.exercise)
    with _shown(Console(stderr=True, highlight=False), exercise.name) as show:
        examination = check_exercise(exercise, mutants=args.mutants, jobs=args.jobs, progress=show)
    for path, text in (
        (args.json, json.dumps(examination.to_json(), indent=2, ensure_ascii=False) + "\n"),
        (args.markdown, examination.to_markdown()),
    ):
        if path is not None:
            _write(path, text)
    _print(examination, Console(highlight=False))
    return int(not examination.is_fine)


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UsageError(f"cannot write {path}: {error.strerror}") from None


def _print(examination: Examination, console: Console) -> None:
    table = Table(
        "check", "catches", title=f"{examination.exercise}: mutants", title_justify="left"
    )
    for check, names in examination.catches.items():
        table.add_row(check, ", ".join(names) or "(none)")
    table.add_row("nobody", ", ".join(examination.uncaught) or "(none)")
    console.print(table)
    for trial in examination.trials:
        for remark in trial.remarks:
            console.print(f"{trial.solution.name}: {remark}", markup=False, soft_wrap=True)
    for problem in examination.problems:
        console.print(f"To mend: {problem}", markup=False, soft_wrap=True)
    count = f"{len(examination.checks)} checks, {len(examination.mutants)} mutants"
    if examination.is_fine:
        console.print(f"All is fine: {count}, each caught.", soft_wrap=True)
    else:
        console.print(f"{len(examination.problems)} to mend; {count}.", soft_wrap=True)


@contextmanager
def _shown(console: Console, name: str) -> Iterator[Progress]:
    """Show which solution is through; yields the function that is told."""
    if console.is_terminal:
        with console.status(f"{name}: running its solutions ...") as status:
            yield lambda count, total, last: status.update(f"{name}: {count} of {total}, {last}")
        return
    yield lambda count, total, last: console.print(
        f"{count}/{total} {last}", markup=False, soft_wrap=True
    )
