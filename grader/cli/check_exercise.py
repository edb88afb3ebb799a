"""Try an exercise on its right solutions and mutants: what each check catches, and what to fix."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table

from grader.cli import options, say
from grader.exercise.loading import load_exercise
from grader.system import files
from grader.system.requirements import require_ros
from grader.text.translations import tr, translate

if TYPE_CHECKING:
    from grader.testing.checking import Progress
    from grader.testing.examination import Examination

NEEDS_LINUX = True


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.epilog = tr(
        "Exit code: 0 all is fine, 1 there is something to mend, 2 it cannot be used."
    )
    parser.add_argument("exercise", metavar="NAME|FOLDER", help=tr("an installed one, or a folder"))
    parser.add_argument(
        "--mutants",
        type=Path,
        metavar="FILE",
        help=tr("the solutions (mutants.yaml in its folder)"),
    )
    parser.add_argument(
        "--jobs", type=options.processes, metavar="N", help=tr("so many at once (one a core)")
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help=tr("write all of it here"))
    parser.add_argument("--markdown", type=Path, metavar="FILE", help=tr("write the table here"))


def main(args: argparse.Namespace) -> int:
    """Try an exercise; 1 if there is something to fix. See `grader.cli` for other exit codes."""
    from grader.testing.checking import check_exercise  # here: only Linux has what it needs

    exercise = load_exercise(args.exercise)
    require_ros()
    with _shown(Console(stderr=True, highlight=False), exercise.name) as show:
        examination = check_exercise(exercise, mutants=args.mutants, jobs=args.jobs, progress=show)
    for path, text in (
        (args.json, json.dumps(examination.to_json(), indent=2, ensure_ascii=False) + "\n"),
        (args.markdown, examination.to_markdown()),
    ):
        if path is not None:
            files.write(path, text)
    _print(examination, Console(highlight=False))
    return int(not examination.is_fine)


def _print(examination: Examination, console: Console) -> None:
    table = Table(
        tr("check"),
        tr("catches"),
        title=tr("{exercise}: mutants", exercise=examination.exercise),
        title_justify="left",
    )
    for check, names in examination.catches.items():
        table.add_row(check, ", ".join(names) or tr("(none)"))
    table.add_row(tr("nobody"), ", ".join(examination.uncaught) or tr("(none)"))
    console.print(table)
    for trial in examination.trials:
        for remark in trial.remarks:
            say(console, f"{trial.solution.name}: {translate(remark)}")
    for trial in examination.parrots:
        passed = [f"{v.check} {v.score:g}" for v in trial.verdicts if v.score]
        text = tr("Who repeats what {solution} sent, and hears nothing, has {points:g} points: "
                  "{checks}",
                  solution=trial.solution.name, points=sum(v.score for v in trial.verdicts),
                  checks=", ".join(passed) or tr("(none)"))  # fmt: skip
        say(console, text)
    for problem in examination.problems:
        say(console, tr("To fix: {problem}", problem=problem.text))
    count = tr(
        "{checks} checks, {mutants} mutants",
        checks=len(examination.checks),
        mutants=len(examination.mutants),
    )
    if examination.is_fine:
        say(console, tr("All is fine: {count}, each caught.", count=count))
    else:
        problems = len(examination.problems)
        say(console, tr("{problems} to fix; {count}.", problems=problems, count=count))


@contextmanager
def _shown(console: Console, name: str) -> Iterator[Progress]:
    """Show the progress; yield the function to call after each solution."""
    if console.is_terminal:
        with console.status(tr("{name}: running its solutions ...", name=name)) as status:
            yield lambda count, total, last: status.update(
                tr(
                    "{name}: {count} of {total}, {last}",
                    name=name,
                    count=count,
                    total=total,
                    last=last,
                )
            )
        return
    yield lambda count, total, last: say(console, f"{count}/{total} {last}")
