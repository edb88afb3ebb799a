"""Forget a student: remove what is kept of one from the folder of a class."""

from __future__ import annotations

import argparse
from pathlib import Path

from rich.console import Console

from grader.cli import JUDGED, say
from grader.exercise import View
from grader.text import msg, tr
from grader_class.cli.batch import add_of_outputs

NEEDS_LINUX = True


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("student", help=tr("the id, name or address; or the pseudonym"))
    folder = tr("the folder of the class")
    parser.add_argument("--from", dest="out", type=Path, required=True, metavar="DIR", help=folder)
    parser.add_argument("--yes", action="store_true", help=tr("do it; else it is only shown"))
    parser.add_argument(
        "--exercise",
        metavar="NAME|FOLDER|FILE",
        help=tr("what the class was judged by, if it is no installed one"),
    )
    add_of_outputs(parser)


def main(args: argparse.Namespace) -> int:
    """Show what would go, and with --yes let it go."""
    from grader import load_exercise
    from grader_class import forget
    from grader_class.class_file import ClassFile
    from grader_class.store import Store

    console = Console(highlight=False)
    of_class = ClassFile.read(args.out)
    path = args.exercise or of_class.exercise
    exercise = load_exercise(path)
    of_class.check_exercise(args.out, exercise, path)
    with Store.opened(args.out) as store:
        plan = forget.plan(store, args.student)
        say(console, f"{plan.person.id} {plan.person.name}".strip(), "bold")
        for folder in plan.goes:
            say(console, msg("- goes: {folder}", folder=folder))
        for entry, _ in plan.groups:
            say(console, msg("- stays without this member: {folder}", folder=entry.folder))
        if exercise.sha256 != of_class.exercise_sha256:
            say(console, msg("Note: the class had another version of the exercise: use --exercise"))
        if not args.yes:
            say(console, msg("Nothing was changed. To do it: the same call with --yes"))
            return JUDGED
        view: View = "after_due" if args.after_due else "student"
        forget.carry_out(plan, store, exercise, view, args.assignment)
    note = msg(
        "Forgotten. What was handed in, the roster and copies of this folder are not here: delete "
        "the student there, or the next grader batch grades what is there again."
    )
    say(console, note)
    return JUDGED
