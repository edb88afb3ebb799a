"""`grader batch`: grade a class, or judge it again by a changed rubric, and say how that goes."""

from __future__ import annotations

import os
from argparse import Namespace
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path

from rich.console import Console

from grader import Exercise, UsageError, exercise_for, load_exercise
from grader.cli import GRADER_FAILED, JUDGED, options, say
from grader.exercise import View
from grader.run import cores, levels, marks_of
from grader.system import files, requirements
from grader.text import NOTHING, Message, joined, listed, msg
from grader_class import batch, class_file, cluster, pool, pseudonyms, regrade
from grader_class.batch import Order, Work
from grader_class.class_file import CLASS, ClassFile
from grader_class.cli import class_progress
from grader_class.entry import Entry, HandIn, entries
from grader_class.find.finding import Found, find
from grader_class.gradebook import write
from grader_class.pseudonyms import Pseudonyms
from grader_class.store import ASIDE, Store

#: Of the hand-ins that could not be judged again, so many are listed; the table has all.
_MOST_FAILURES = 20


def grade_class(args: Namespace) -> int:
    """Grade a class, and return the exit code; 3: the grader failed for some hand-ins."""
    if args.scheduler:  # a worker works in another folder
        args.submissions, args.out = args.submissions.absolute(), args.out.absolute()
    else:
        requirements.require_ros(args.time)
        if args.isolation:
            levels.require(args.isolation)
    messages = Console(stderr=True, highlight=False)
    exercise = load_exercise(args.exercise) if args.exercise else None  # refused at once
    secret = options.secret_of(args)
    hidden = _pseudonyms(args, messages)
    with _found(args, messages, hidden) as (store, found, named):
        if exercise is None:
            args.named = _named(found, messages) or args.named
            exercise = load_exercise(args.named)
        batch.check_lateness(found.hand_ins, exercise)
        path = args.exercise or args.named
        order = Order(
            exercise=exercise,
            exercise_path=path if path == exercise.name else str(Path(path).absolute()),
            time=args.time,
            seed=args.seed,
            again=args.again,
            secret=secret,
            hides_seed=options.hides_seed(args),
            pseudonyms="" if hidden is None else hidden.mark,
            isolation=class_file.begun_at(args.out, args.again, args.isolation or ""),
            executable=args.executable,
            launch=options.launch_asked(args.launch),
        )
        batch.check_same_class(store, order.class_file, order.again)
        _grade(args, order, found, store, messages)
        graded = entries(args.out)
        view = _view(args)
        notes = batch.write_outputs(args.out, graded, exercise, view, args.assignment)
        if args.names and hidden is not None:
            notes = _write_names(args, graded, named, hidden, exercise)
        elif hidden is not None:
            notes = [msg("Gradebook and imports with names, for a course system: --names")]
        for note in notes:
            say(messages, note)
    class_progress.summarise(messages, graded, args.out)
    return GRADER_FAILED if any(entry.state == "failed" for entry in graded) else JUDGED


def regrade_class(args: Namespace) -> int:
    """Print the effects of a changed rubric on a class as CSV, and with --apply write them.

    The table is also written into --out, or into the folder of the class. The exit code is 3 if
    some could not be judged again.
    """
    out, folder = Path(args.regrade), Path(args.out or args.regrade)
    messages, of_class = Console(stderr=True, highlight=False), ClassFile.read(out)
    path = args.exercise or of_class.exercise
    say(messages, msg("judging {n} hand-ins again ...", n=of_class.hand_ins))
    with Store.opened(out) if args.apply else nullcontext() as store:
        found = regrade.regrade(out, path, _jobs(args), store)
        files.make_folder(folder)
        files.put(folder / regrade.CHANGES, found.table.encode("utf-8"))
        print(found.table, end="", flush=True)
        if store is not None:
            regrade.apply(found, store, _view(args), args.assignment)
    say(messages, found.headline)
    for note in found.notes:
        say(messages, msg("Note: {flag}", flag=note))
    for entry, why in found.failures[:_MOST_FAILURES]:
        say(messages, msg("Left as it is, not judged again: {who}: {why}", who=entry.id, why=why))
    if store is None:
        say(messages, msg("The class was not changed. To change it: the same call with --apply"))
    return GRADER_FAILED if found.failures else JUDGED


def _view(args: Namespace) -> View:
    return "after_due" if args.after_due else "student"


def _jobs(args: Namespace) -> int:
    return args.jobs or max(1, round(cores.share()))


def _named(found: Found, messages: Console) -> str:
    """Return the one exercise that hand-ins name; '' for none."""
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
    return next(iter(named), "")


def _pseudonyms(args: Namespace, messages: Console) -> Pseudonyms | None:
    """Return who gives the students their pseudonyms; None where they keep their names."""
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
    args: Namespace,
    graded: Sequence[Entry],
    named: Mapping[str, HandIn],
    hidden: Pseudonyms,
    exercise: Exercise,
) -> list[Message]:
    """Write the gradebook and the imports of a class under pseudonyms with names; return notes.

    What is made is readable for its owner alone. Hand-ins that are not among the submissions any
    more are left out: nothing tells whose they are.
    """
    of_names = [
        replace(each, hand_in=replace(named[each.id], path=None, problem=each.hand_in.problem))
        for each in graded
        if each.id in named
    ]
    before = os.umask(0o077)
    try:
        notes = write.write(args.names, of_names, exercise.title, _view(args), args.assignment)
        write.write_pseudonyms(args.names, of_names, hidden.of)
    finally:
        os.umask(before)
    return [*notes, msg("Gradebook and imports with names: {folder}", folder=args.names)]


@contextmanager
def _found(
    args: Namespace, messages: Console, hidden: Pseudonyms | None
) -> Iterator[tuple[Store, Found, dict[str, HandIn]]]:
    """Open the folder of the class, find the hand-ins, and print the notes on them.

    Under pseudonyms the hand-ins come without names, and beside them who has which.
    """
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
            if hidden is None:
                yield store, found, {}
                return
            pairs = hidden.hide(found.hand_ins)
            named = {id: with_names for id, (_, with_names) in pairs.items()}
            args.again = next((id for id, was in named.items() if was.id == args.again), args.again)
            found = replace(found, hand_ins=[without for without, _ in pairs.values()])
            yield store, found, named


def _grade(args: Namespace, order: Order, found: Found, store: Store, messages: Console) -> None:
    planned = batch.plan(found.hand_ins, order, store)
    if args.scheduler:
        work = _on_a_cluster(args, order, store, messages)
    else:
        work = partial(pool.work, jobs=_jobs(args))
        if any(task.run is None for task in planned.tasks):
            order = replace(order, isolation=class_file.on_this_machine(order.isolation))
            class_file.note(args.out, order.isolation)
    if aside := store.set_aside(hand_in.id for hand_in in found.hand_ins):
        note = msg(
            "{n:,} hand-in in {out} not among these submissions, and set aside in {aside}: {names}",
            "{n:,} hand-ins in {out} not among these submissions, and set aside in {aside}: "
            "{names}",
            n=len(aside),
            out=args.out,
            aside=store.out / ASIDE,
            names=listed(aside),
        )
        say(messages, note)
    with class_progress.shown(messages, planned, store) as show:
        for hand_in in batch.carry_out(planned, order, store, work):
            show(hand_in)


def _on_a_cluster(args: Namespace, order: Order, store: Store, messages: Console) -> Work:
    inputs = [args.submissions]
    if order.exercise_path != order.exercise.name:
        inputs.append(Path(order.exercise_path))
    terms = cluster.Terms(args.out, store.new_place(), tuple(inputs), order.isolation)
    notify = partial(say, messages)
    return lambda tasks: cluster.work(tasks, args.scheduler, terms, notify, args.isolation or "")
