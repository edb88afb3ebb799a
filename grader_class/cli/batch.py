"""Grade a class: find the submissions, and grade them in parallel."""

from __future__ import annotations

import argparse
from pathlib import Path

from grader import UsageError
from grader.cli import options
from grader.text import msg, tr

NEEDS_LINUX = True


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "submissions",
        type=Path,
        nargs="?",
        help=tr(
            "the folder or archive that a course system exports, or a folder with "
            "one file, folder or archive a student"
        ),
    )
    parser.add_argument("--out", type=Path, metavar="DIR", help=tr("the folder of the class"))
    parser.add_argument(
        "--jobs",
        type=options.processes,
        metavar="N",
        help=tr("so many gradings at once (as many as cores)"),
    )
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help=tr("grade on the workers of a Dask cluster instead, which share a folder"),
    )
    options.add_of_runs(
        parser,
        tr("the clock that submissions live by"),
        tr(
            "refuse to run submissions confined less well: {levels}",
            levels=", ".join(options.LEVELS),
        ),
    )
    options.add_of_start(parser)
    parser.add_argument("--pattern", metavar="P", help=tr("how names tell whose a submission is"))
    parser.add_argument(
        "--roster", type=Path, metavar="FILE", help=tr("names: a CSV with a column id")
    )
    parser.add_argument(
        "--pseudonyms",
        type=Path,
        metavar="KEY",
        help=tr("show pseudonyms of the students, made of the key in this file outside of DIR"),
    )
    parser.add_argument(
        "--names",
        type=Path,
        metavar="FOLDER",
        help=tr("of --pseudonyms: gradebook and imports with names, outside of DIR"),
    )
    parser.add_argument(
        "--again",
        default="",
        metavar="failed|all|ID",
        help=tr("grade anew: where the grader failed, everything, or one"),
    )
    parser.add_argument(
        "--regrade",
        type=Path,
        metavar="DIR",
        help=tr("show what --exercise would change in the class of this folder; run nothing"),
    )
    parser.add_argument(
        "--apply",
        action="store_true",
        help=tr("with --regrade: write it"),
    )
    add_of_outputs(parser)


def add_of_outputs(parser: argparse.ArgumentParser) -> None:
    """Declare the options for what is written of a whole class."""
    parser.add_argument(
        "--after-due",
        action="store_true",
        help=tr("students may see now what their exercise hides until it is due"),
    )
    parser.add_argument(
        "--assignment",
        default="",
        metavar="NAME",
        help=tr('what Canvas calls the exercise, as in "Spiral (4711)" (its title)'),
    )


def main(args: argparse.Namespace) -> int:
    """Grade a class, and return the exit code; 3: the grader failed for some hand-ins."""
    _check_words(args)
    from grader_class.cli import grading  # imports what Linux alone has

    return grading.regrade_class(args) if args.regrade else grading.grade_class(args)


def _check_words(args: argparse.Namespace) -> None:
    """Refuse options that contradict each other, or lack another one."""
    if bool(args.submissions) == bool(args.regrade):
        raise UsageError(msg("name one: the submissions, or a class to --regrade"))
    if args.apply and not args.regrade:
        raise UsageError(msg("--apply belongs to --regrade DIR"))
    if args.names and not args.pseudonyms:
        raise UsageError(msg("--names belongs to --pseudonyms KEY"))
    if args.pseudonyms and args.regrade:
        raise UsageError(
            msg("--regrade takes no --pseudonyms: a class keeps those that it was graded with")
        )
    if args.out is None and not args.regrade:
        raise UsageError(msg("name a folder for the class: --out DIR"))
