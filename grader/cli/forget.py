"""Forget a student: remove what is kept of one from the folder of a class."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from grader.cli import JUDGED, agreed, options, say
from grader.errors import UsageError
from grader.message import msg, msg_many
from grader.translations import tr, translate

if TYPE_CHECKING:
    from grader.batch.class_file import ClassFile
    from grader.batch.forget.receipt import Receipt
    from grader.batch.forget.whom import Whom
    from grader.result.visible import View

#: So many words that will be replaced are shown.
_MOST_WORDS = 20


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("student", help=tr("the id, name or address; or the pseudonym"))
    parser.add_argument(
        "--from",
        dest="out",
        type=Path,
        required=True,
        metavar="DIR",
        help=tr("the folder of the class"),
    )
    parser.add_argument(
        "--yes", action="store_true", help=tr("do not ask; without a terminal nobody is asked")
    )
    parser.add_argument(
        "--pseudonyms",
        type=Path,
        metavar="KEY",
        help=tr("of a class under pseudonyms: the key, if the student is named by the id"),
    )
    parser.add_argument(
        "--also",
        action="append",
        default=[],
        metavar="NAME",
        help=tr("another name of the student that texts may have; may be repeated"),
    )
    parser.add_argument(
        "--exercise",
        metavar="NAME|FOLDER|FILE",
        help=tr("what the class was judged by, if it is no installed one"),
    )
    parser.set_defaults(named=None)
    options.add_of_outputs(parser)


def main(args: argparse.Namespace) -> int:
    """Show what would go, ask, and let it go."""
    from grader.batch.class_file import ClassFile
    from grader.batch.forget import forgetting, receipt, whom
    from grader.batch.names.people import known_words
    from grader.batch.store import Store
    from grader.exercise.loading import load_exercise
    from grader.submission.folder import listed

    console = Console(highlight=False)
    described = ClassFile.read(args.out)
    exercise = load_exercise(args.exercise or described.exercise)
    if exercise.name != described.exercise:
        raise UsageError(
            "{out} was graded for the exercise {then!r}, and this is {now!r}: name that one with "
            "--exercise. Nothing was changed.",
            out=str(args.out),
            then=described.exercise,
            now=exercise.name,
        )
    with Store.opened(args.out) as store:
        kept = whom.all_kept(args.out)
        also = [*args.also, args.student] if args.pseudonyms else args.also
        typed = args.student if args.pseudonyms else ""
        found = whom.find(_asked(args, described), kept, known_words(exercise), also, typed)
        plan = forgetting.plan(store, kept, found)
        say(console, _who(found), "bold")
        for line in receipt.described(plan.counts):
            say(console, f"- {translate(line)}")
        if found.shared:
            say(
                console,
                msg(
                    "Others have these parts of the name, too, so that they stay in texts: {parts}",
                    parts=", ".join(found.shared),
                ),
            )
        if plan.words:
            say(
                console,
                msg(
                    "In what others keep, the name is replaced in: {words}",
                    words=listed(plan.words, _MOST_WORDS),
                ),
            )
        if described.pseudonyms and not args.also:
            say(
                console,
                msg(
                    "The sources of others may have the name itself, which this class does not "
                    "know: --also NAME replaces it, too."
                ),
            )
        if not args.yes and not _is_wanted(console):
            return JUDGED
        view: View = "after_due" if args.after_due else "student"
        done, left = forgetting.carry_out(plan, store, exercise, view, args.assignment)
    say(console, msg("Forgotten. Receipt: {path}", path=receipt.path_of(args.out, done.number)))
    _say_what_stays(console, done, left)
    return JUDGED


def _asked(args: argparse.Namespace, described: ClassFile) -> str:
    """Return whom to look for: by a key, the pseudonym."""
    from grader.batch.names.pseudonyms import STUDENT, Pseudonyms, read_key

    if args.pseudonyms is None:
        if described.pseudonyms and not args.student.startswith(STUDENT):
            raise UsageError(
                "{out} is under pseudonyms: give one of these, or the id with --pseudonyms KEY. "
                "Nothing was changed.",
                out=str(args.out),
            )
        return str(args.student)
    made = Pseudonyms(read_key(args.pseudonyms, (args.out,), may_make=False))
    if made.mark != described.pseudonyms:
        raise UsageError(
            "{out} was not graded with this key. Nothing was changed.", out=str(args.out)
        )
    return made.of(args.student)


def _who(found: Whom) -> str:
    person = found.person
    return f"{person.id}, {person.name}" if person.name else person.id


def _is_wanted(console: Console) -> bool:
    if sys.stdin.isatty():
        if agreed(tr("Forget this student, for ever? [yes/no] ")):
            return True
        say(console, msg("Nothing was changed."))
        return False
    say(console, msg("Nothing was changed. To do it: the same call with --yes"))
    return False


def _say_what_stays(console: Console, done: Receipt, left: Sequence[Path]) -> None:
    if done.unplayable:
        lost = msg_many(
            "{n:,} recording of others could not be kept without the name, and is gone.",
            "{n:,} recordings of others could not be kept without the name, and are gone.",
            done.unplayable,
        )
        say(console, lost)
    if left:
        there = msg_many(
            "The name is still in {n:,} file, which is not the grader's:",
            "The name is still in {n:,} files, which are not the grader's:",
            len(left),
        )
        say(console, there, "red")
        for path in left:
            say(console, f"  {path}")
    say(
        console,
        msg(
            "What was handed in, the roster and copies of this folder are not here: delete the "
            "student there, or the next grader batch grades them again."
        ),
    )
