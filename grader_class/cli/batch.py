"""Grade a class: find the submissions, and grade them in parallel."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from grader import UsageError
from grader.cli import GRADER_FAILED, JUDGED, options, say
from grader.system import DEFAULT_EXERCISE, require_ros
from grader.text import NOTHING, Message, joined, msg, msg_many, tr

if TYPE_CHECKING:
    from grader import Exercise
    from grader.exercise import View
    from grader_class.batch import Order, Work
    from grader_class.entry import Entry, HandIn
    from grader_class.find.finding import Found
    from grader_class.pseudonyms import Pseudonyms
    from grader_class.store import Store

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
    options.add_of_outputs(parser)


def main(args: argparse.Namespace) -> int:
    """Grade a class, and return the exit code; 3: the grader failed for some hand-ins."""
    _check_words(args)
    view: View = "after_due" if args.after_due else "student"
    if args.regrade:
        from grader_class.cli import regrading

        return regrading.run(args, _jobs_of(args), view)
    if args.scheduler:  # a worker works in another folder
        args.submissions, args.out = args.submissions.absolute(), args.out.absolute()
    else:
        require_ros(args.time)
    if args.isolation and not args.scheduler:
        from grader.run import levels

        levels.require(args.isolation)
    from grader import load_exercise
    from grader_class import batch
    from grader_class.batch import Order, check_same_class
    from grader_class.class_file import begun_at
    from grader_class.cli import class_progress
    from grader_class.entry import entries

    messages = Console(stderr=True, highlight=False)
    exercise = load_exercise(args.exercise) if args.exercise else None  # refused at once
    secret = options.secret_of(args)
    pseudonyms = _pseudonyms(args, messages)
    with _found(args, messages, pseudonyms) as (store, found, named):
        if exercise is None:
            args.named = _named(found, messages)
            exercise = load_exercise(args.named)
        path = args.exercise or args.named
        order = Order(
            *(exercise, path if path == exercise.name else str(Path(path).absolute())),
            *(args.time, args.seed, args.again),
            secret=secret,
            hides_seed=options.hides_seed(args),
            pseudonyms="" if pseudonyms is None else pseudonyms.mark,
            isolation=begun_at(args.out, args.again, args.isolation or ""),
            executable=args.executable,
            launch=options.launch_asked(args.launch),
        )
        check_same_class(store, order.class_file, order.again)
        _grade(args, order, found, store, messages)
        graded = entries(args.out)
        written = batch.write_outputs(args.out, graded, exercise, view, args.assignment)
        if args.names and pseudonyms is not None:
            written = _write_names(args, graded, named, pseudonyms, exercise, view)
        elif pseudonyms is not None:
            written = [msg("Gradebook and imports with names, for a course system: --names")]
        for note in written:
            say(messages, note)
    class_progress.summarise(messages, graded, args.out)
    return GRADER_FAILED if any(entry.state == "failed" for entry in graded) else JUDGED


def _named(found: Found, messages: Console) -> str:
    """Return the one exercise that hand-ins name, else the default one."""
    from grader import exercise_for
    from grader.run import marks_of
    from grader.text import listed

    named: dict[str, list[str]] = {}
    said = NOTHING
    for hand_in in found.hand_ins:
        if hand_in.path is not None and len((marks := marks_of(hand_in.path)).exercises) == 1:
            name, said = exercise_for(hand_in.path, marks)
            named.setdefault(name, []).append(hand_in.id)
    if len(named) > 1:
        who = (joined([name, listed(ids, 3)], ": ") for name, ids in named.items())
        raise UsageError(
            "the hand-ins name several exercises ({who}), and a class has one: choose it with "
            "--exercise. Nothing was changed.",
            who=joined(list(who), "; "),
        )
    say(messages, said)
    return next(iter(named), DEFAULT_EXERCISE)


def _pseudonyms(args: argparse.Namespace, messages: Console) -> Pseudonyms | None:
    """Return who gives the students their pseudonyms; None where they keep their names."""
    from grader_class import pseudonyms

    if not args.pseudonyms:
        return None
    is_new = not os.path.lexists(args.pseudonyms)
    made = pseudonyms.of_class(args.pseudonyms, args.out, args.submissions, args.names)
    if is_new:
        note = msg(
            "Made the key {path}. Keep it: without it nobody can go on with this class, nor tell "
            "who is who.",
            path=str(args.pseudonyms),
        )
        say(messages, note)
    return made


def _write_names(
    args: argparse.Namespace,
    graded: Sequence[Entry],
    named: Mapping[str, HandIn],
    pseudonyms: Pseudonyms,
    exercise: Exercise,
    view: View,
) -> list[Message]:
    """Write the gradebook and the imports of a class under pseudonyms with names; return notes.

    What is made is readable for its owner alone. Hand-ins that are not among the submissions any
    more are left out: nothing tells whose they are.
    """
    from grader_class.gradebook import write

    entries = [
        replace(each, hand_in=replace(named[each.id], path=None, problem=each.hand_in.problem))
        for each in graded
        if each.id in named
    ]
    before = os.umask(0o077)
    try:
        notes = write.write(args.names, entries, exercise.title, view, args.assignment)
        write.write_pseudonyms(args.names, entries, pseudonyms.of)
    finally:
        os.umask(before)
    return [*notes, msg("Gradebook and imports with names: {folder}", folder=args.names)]


@contextmanager
def _found(
    args: argparse.Namespace, messages: Console, pseudonyms: Pseudonyms | None
) -> Iterator[tuple[Store, Found, dict[str, HandIn]]]:
    """Open the folder of the class, find the hand-ins, and print the notes on them.

    Under pseudonyms the hand-ins come without names, and beside them who has which.
    """
    from grader_class.class_file import CLASS
    from grader_class.find.finding import find
    from grader_class.store import Store

    is_same = args.submissions.resolve() == args.out.resolve()
    if is_same or (args.submissions / CLASS).is_file():
        raise UsageError(
            "{submissions} is the folder of a class, which `grader batch` writes "
            "into; name the submissions themselves. Nothing was changed.",
            submissions=args.submissions,
        )
    with Store.opened(args.out) as store:
        # what is unpacked has to be seen by all machines of a cluster
        place = store.new_place() if args.scheduler else None
        with find(args.submissions, args.pattern, args.roster, place) as found:
            for note in found.notes:
                say(messages, note)
            if pseudonyms is None:
                yield store, found, {}
                return
            hidden = pseudonyms.hide(found.hand_ins)
            named = {id: with_names for id, (_, with_names) in hidden.items()}
            args.again = next((id for id, was in named.items() if was.id == args.again), args.again)
            found = replace(found, hand_ins=[without for without, _ in hidden.values()])
            yield store, found, named


def _grade(
    args: argparse.Namespace, order: Order, found: Found, store: Store, messages: Console
) -> None:
    from grader.text import listed
    from grader_class import batch, class_file, pool
    from grader_class.cli import class_progress
    from grader_class.store import ASIDE

    planned = batch.plan(found.hand_ins, order, store)
    if args.scheduler:
        work = _on_a_cluster(args, order, store, messages)
    else:
        work = partial(pool.work, jobs=_jobs_of(args))
        if any(task.run is None for task in planned.tasks):
            order = replace(order, isolation=class_file.on_this_machine(order.isolation))
            class_file.note(args.out, order.isolation)
    if aside := store.set_aside(hand_in.id for hand_in in found.hand_ins):
        note = msg_many(
            "{n:,} hand-in in {out} not among these submissions, and set aside in {aside}: {names}",
            "{n:,} hand-ins in {out} not among these submissions, and set aside in {aside}: "
            "{names}",
            len(aside),
            out=args.out,
            aside=store.out / ASIDE,
            names=listed(aside),
        )
        say(messages, note)
    with class_progress.shown(messages, planned, store) as show:
        for hand_in in batch.carry_out(planned, order, store, work):
            show(hand_in)


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


def _jobs_of(args: argparse.Namespace) -> int:
    from grader.run import cores

    return args.jobs or max(1, round(cores.share()))


def _on_a_cluster(args: argparse.Namespace, order: Order, store: Store, messages: Console) -> Work:
    from grader_class import cluster

    inputs = [args.submissions]
    if order.exercise_path != order.exercise.name:
        inputs.append(Path(order.exercise_path))
    terms = cluster.Terms(args.out, store.new_place(), tuple(inputs), order.isolation)
    notify = partial(say, messages)
    return lambda tasks: cluster.work(tasks, args.scheduler, terms, notify, args.isolation or "")
