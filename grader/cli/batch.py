"""Grade a class: find the submissions, grade them in parallel, and look at them together."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.text import Text

from grader.cli.run import CLOCKS, LEVELS
from grader.errors import UsageError
from grader.exercise import DEFAULT
from grader.language.phrase import say
from grader.language.telling import tell, tell_many, told
from grader.text import for_terminal

if TYPE_CHECKING:
    from grader.batch.batch import Order, Work
    from grader.batch.find import Found
    from grader.batch.store import Store
    from grader.result.visible import View

JUDGED, GRADER_FAILED = 0, 3


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "submissions",
        type=Path,
        nargs="?",
        help=tell(
            "the folder or archive that a course system exports, or a folder with "
            "one file, folder or archive a student"
        ),
    )
    parser.add_argument("--out", type=Path, metavar="DIR", help=tell("the folder of the class"))
    parser.add_argument(
        "--jobs",
        type=processes,
        metavar="N",
        help=tell("so many gradings at once (as many as cores)"),
    )
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help=tell("grade on the workers of a dask cluster instead"),
    )
    parser.add_argument(
        "--exercise",
        default=DEFAULT,
        metavar="NAME|FOLDER|FILE",
        help=tell("an installed one, the folder of another, or an edited exercise.yaml"),
    )
    parser.add_argument(
        "--time", choices=CLOCKS, default="virtual", help=tell("the clock that submissions live by")
    )
    parser.add_argument(
        "--seed",
        type=int,
        metavar="N",
        help=tell("where the varied runs start (the exercise's own)"),
    )
    parser.add_argument("--pattern", metavar="P", help=tell("how names tell whose a submission is"))
    parser.add_argument(
        "--roster", type=Path, metavar="FILE", help=tell("names: a CSV with a column id")
    )
    parser.add_argument(
        "--again",
        default="",
        metavar="failed|all|ID",
        help=tell("grade anew: where the grader failed, everything, or one"),
    )
    parser.add_argument(
        "--regrade",
        type=Path,
        metavar="DIR",
        help=tell("show what --exercise would change in the class of this folder; run nothing"),
    )
    parser.add_argument(
        "--apply",
        action="store_true",
        help=tell("with --regrade: write it; what was before is kept"),
    )
    parser.add_argument(
        "--after-due",
        action="store_true",
        help=tell("students may see now what their exercise hides until it is due"),
    )
    parser.add_argument(
        "--assignment",
        default="",
        metavar="NAME",
        help=tell('what Canvas calls the exercise, as in "Spiral (4711)" (its title)'),
    )
    parser.add_argument(
        "--isolation",
        choices=LEVELS,
        metavar="LEVEL",
        help=tell(
            "refuse to run submissions confined less well: {levels}", levels=", ".join(LEVELS)
        ),
    )


def main(args: argparse.Namespace) -> int:
    """Grade a class; 0: all are judged, 3: the grader failed for some."""
    _check_words(args)
    view: View = "after_due" if args.after_due else "student"
    if args.regrade:
        from grader.cli import regrading

        return regrading.run(args, _jobs_of(args), view)
    if args.isolation and not args.scheduler:
        from grader.run.processes import levels

        levels.require(args.isolation)
    from grader.batch import outputs
    from grader.batch.batch import Order, check_same_class
    from grader.batch.entry import entries
    from grader.batch.level import begun_at
    from grader.batch.store import Store
    from grader.cli import class_progress
    from grader.exercise.loading import load_exercise

    exercise = load_exercise(args.exercise)
    path = args.exercise if args.exercise == exercise.name else str(Path(args.exercise).absolute())
    order = Order(exercise, path, args.time, args.seed, args.again)
    messages = Console(stderr=True, highlight=False)
    with _found(args, messages) as found, Store.opened(args.out) as store:
        order = replace(order, isolation=begun_at(store, args.again, args.isolation or ""))
        check_same_class(store, order.class_file, order.again)
        _grade(args, order, found, store, messages)
        graded = entries(args.out)
        _tell(messages, outputs.write(args.out, graded, exercise, view, args.assignment))
    class_progress.summarise(messages, graded, args.out)
    return GRADER_FAILED if any(entry.state == "failed" for entry in graded) else JUDGED


@contextmanager
def _found(args: argparse.Namespace, messages: Console) -> Iterator[Found]:
    """Who has handed in what."""
    from grader.batch.class_file import CLASS
    from grader.batch.find import find

    if (args.submissions / CLASS).is_file() or _are_same(args.submissions, args.out):
        raise UsageError(
            say(
                "{submissions} is the folder of a class, which `grader batch` writes "
                "into; name the submissions themselves. Nothing was changed.",
                submissions=args.submissions,
            )
        )
    with find(args.submissions, args.pattern, args.roster) as found:
        _tell(messages, found.notes)
        yield found


def _are_same(one: Path, other: Path) -> bool:
    return one.resolve() == other.resolve()


def _grade(
    args: argparse.Namespace, order: Order, found: Found, store: Store, messages: Console
) -> None:
    from grader.batch import batch, level
    from grader.batch.store import ASIDE
    from grader.cli import class_progress
    from grader.submission.folder import listed

    planned = batch.plan(found.hand_ins, order, store)
    if args.scheduler:
        work = _on_a_cluster(args, order, store, messages)
    else:
        work = _on_this_machine(args)
        if any(task.run is None for task in planned.tasks):
            order = replace(order, isolation=level.on_this_machine(order.isolation))
            level.note(store, order.isolation)
    if aside := store.set_aside(hand_in.id for hand_in in found.hand_ins):
        note = tell_many(
            "{n:,} hand-in in {out} not among these submissions, and set aside in {aside}: {names}",
            "{n:,} hand-ins in {out} not among these submissions, and set aside in {aside}: "
            "{names}",
            len(aside),
            out=args.out,
            aside=store.out / ASIDE,
            names=listed(aside),
        )
        _tell(messages, [note])
    with class_progress.shown(messages, planned, store) as show:
        for hand_in in batch.carry_out(planned, order, store, work):
            show(hand_in)


def _check_words(args: argparse.Namespace) -> None:
    """Refuse a call that asks for two things, or for none."""
    if bool(args.submissions) == bool(args.regrade):
        raise UsageError(say("name one: the submissions, or a class to --regrade"))
    if args.apply and not args.regrade:
        raise UsageError(say("--apply belongs to --regrade DIR"))
    if args.out is None and not args.regrade:
        raise UsageError(say("name a folder for the class: --out DIR"))


def _jobs_of(args: argparse.Namespace) -> int:
    from grader.run.processes import cores

    return args.jobs or max(1, round(cores.share()))


def _on_this_machine(args: argparse.Namespace) -> Work:
    from grader.batch import pool

    jobs = _jobs_of(args)
    return lambda tasks: pool.work(tasks, jobs)


def _on_a_cluster(args: argparse.Namespace, order: Order, store: Store, messages: Console) -> Work:
    from grader.batch import cluster, level

    def tell(note: str) -> None:
        _tell(messages, [note])

    isolation = level.OfCluster(order.isolation, args.isolation or "", partial(level.note, store))
    return lambda tasks: cluster.work(tasks, args.scheduler, tell, isolation)


def _tell(console: Console, notes: Sequence[str]) -> None:
    for note in notes:
        console.print(Text(for_terminal(told(note))), soft_wrap=True)


def processes(text: str) -> int:
    """A number of processes from the command line."""
    if not re.fullmatch(r"[1-9]\d{0,3}", text):
        raise argparse.ArgumentTypeError(
            tell("expected a number of processes, found {text}", text=text)
        )
    return int(text)
