"""Forget a student: what would go, and letting it go.

The order makes it safe to be cut off at any moment: what others share comes first, and the
student's own hand-ins last. As long as one of these is there, the same call finds the student again
and does the rest.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from grader.batch import batch
from grader.batch.class_file import ClassFile
from grader.batch.entry import SUBMISSIONS, Entry, HandIn, id_of
from grader.batch.find.newest import safe_id
from grader.batch.forget import older, receipt, rewriting
from grader.batch.forget.receipt import Receipt
from grader.batch.forget.search import files_with
from grader.batch.forget.whom import Kept, Whom
from grader.batch.names.recorded import without_names
from grader.batch.store import ASIDE, STUDENTS, Store
from grader.exercise.exercise import Exercise
from grader.removal import remove
from grader.result.visible import View


@dataclass(frozen=True)
class Plan:
    """What is to be done.

    Attributes:
        kept: all hand-ins of the class's folder.
        own: hand-ins of the student alone, in the class, in `aside` and in what regrades have kept.
        groups: with what they are without the student.
        runs: that nobody else has, by key.
        others: hand-ins of others with the student's names in them, by run.
        words: of what others keep, with the names in them.
        counts: what goes, and what changes.
    """

    out: Path
    whom: Whom
    kept: tuple[Kept, ...]
    own: tuple[Kept, ...]
    groups: tuple[tuple[Kept, HandIn], ...]
    runs: tuple[str, ...]
    others: tuple[tuple[Kept, ...], ...]
    words: tuple[str, ...]
    counts: Counter[str] = field(default_factory=Counter)

    @property
    def renamed(self) -> dict[str, str]:
        """The ids that hand-ins with the student have, and will have; '' for none."""
        found = {each.entry.id: "" for each in self.own}
        return found | {each.entry.id: hand_in.id for each, hand_in in self.groups}


def plan(store: Store, kept: Sequence[Kept], whom: Whom) -> Plan:
    """Plan what is to be done; nothing is changed."""
    theirs = [each for each in kept if whom.is_in(each.entry)]
    own = [each for each in theirs if whom.is_alone_in(each.entry)]
    groups = [(each, _without(each, kept, whom)) for each in theirs if whom.others(each.entry)]
    others = [each for each in kept if not whom.is_alone_in(each.entry)]
    used = {each.entry.key for each in others if not each.is_older}
    keys = {each.entry.key for each in own if not each.is_older} - used
    runs = sorted(key for key in keys if store.has(key))
    words = set[str]()
    shared = [
        tuple(sharing)
        for sharing in rewriting.by_run(each for each in others if not each.is_older)
        if rewriting.mentions(sharing, store, whom, words)
    ]
    made = Plan(
        *(store.out, whom, tuple(kept), tuple(own), tuple(groups), tuple(runs), tuple(shared)),
        tuple(sorted(words)),
    )
    made.counts.update(_counts(made))
    return made


def _counts(made: Plan) -> Iterator[str]:
    for each in made.own:
        yield {SUBMISSIONS: "hand_ins", ASIDE: "set_aside"}.get(each.part, "replaced_results")
    yield from ("groups" for each, _ in made.groups if not each.is_older)
    yield from ("runs" for _ in made.runs)
    for sharing in made.others:
        yield from ("others" for each in sharing if not made.whom.is_in(each.entry))
    for folder in older.folders(made.out):
        yield from older.take_out(folder, made.whom, made.renamed, really=False).elements()


def carry_out(
    made: Plan,
    store: Store,
    exercise: Exercise,
    view: View = "student",
    assignment: str = "",
) -> tuple[Receipt, list[Path]]:
    """Do what is planned, and write the class's pages and tables anew.

    Returns:
        The receipt, and the files that still have the name: others than the grader's.

    Raises:
        UsageError: something cannot be written; the same call goes on where this one ended.
    """
    written = receipt.begun(made.out, made.counts)
    lost = 0
    for sharing in made.others:
        lost += not rewriting.rewrite(sharing, store, made.whom)
    for folder in older.folders(made.out):
        older.take_out(folder, made.whom, made.renamed, really=True)
    _rewrite_older(made)
    for key in made.runs:
        remove(store.run(key))
    remaining = list(_remaining(made))
    batch.write_outputs(made.out, remaining, exercise, view, assignment)
    _count_in_class_file(made)
    for each, hand_in in made.groups:
        if not each.is_older:
            _rename(each, hand_in, store, made.whom)
    for each in made.own:
        store.take_out(each.entry.folder)
    left = files_with(made.out, made.whom.names)
    return receipt.finished(made.out, written, lost, len(left)), left


def _without(each: Kept, kept: Sequence[Kept], whom: Whom) -> HandIn:
    """Return a group's hand-in without one of its members, under an id that nobody else has."""
    hand_in, people = each.entry.hand_in, whom.others(each.entry)
    wanted = id = safe_id(id_of([person.id for person in people]))
    theirs = {e.entry.id: e.entry for e in kept if e.part == each.part}
    number = 2
    while (other := theirs.get(id)) and not _is_made_of(other, each.entry, people):
        id, number = f"{wanted}-{number}", number + 1
    return whom.without(replace(hand_in, id=id, people=people))


def _is_made_of(other: Entry, entry: Entry, people: Sequence[object]) -> bool:
    """Whether an entry is what an interrupted call has made of another one."""
    is_same = other.key == entry.key and other.hand_in.attempt == entry.hand_in.attempt
    return is_same and other.hand_in.people == people and other.hand_in.at == entry.hand_in.at


def _rewrite_older(made: Plan) -> None:
    changed = {id(each): hand_in for each, hand_in in made.groups}
    for each in made.kept:
        if not each.is_older or made.whom.is_alone_in(each.entry):
            continue
        hand_in = changed.get(id(each)) or made.whom.without(each.entry.hand_in)
        names = made.whom.names_for(each.entry.key)
        is_new = rewriting.rewrite_older(each, hand_in, names)
        if is_new and hand_in.id != each.entry.id:
            remove(each.entry.folder)


def _remaining(made: Plan) -> Iterator[Entry]:
    """Yield the entries of the class without the student, as they are on the disk by now."""
    renamed = {each.entry.id: hand_in for each, hand_in in made.groups if each.part == SUBMISSIONS}
    gone = {each.entry.id for each in made.own if each.part == SUBMISSIONS}
    taken = {hand_in.id for hand_in in renamed.values()}
    for each in made.kept:
        if each.part != SUBMISSIONS or each.entry.id in gone | taken:
            continue
        entry = Entry.read(each.entry.folder)
        hand_in = renamed.get(entry.id)
        if hand_in is None:
            yield entry
            continue
        result = entry.result and rewriting.of_hand_in(entry.result, hand_in)
        yield replace(entry, hand_in=hand_in, result=result)


def _count_in_class_file(made: Plan) -> None:
    found = ClassFile.read(made.out)
    gone = sum(each.part == SUBMISSIONS for each in made.own)
    counted = len({each.entry.id for each in made.kept if each.part == SUBMISSIONS}) - gone
    if found.hand_ins > counted:
        replace(found, hand_ins=max(counted, found.hand_ins - gone)).put(made.out)


def _rename(each: Kept, hand_in: HandIn, store: Store, whom: Whom) -> None:
    entry = Entry.read(each.entry.folder)
    names = whom.names_for(entry.key)
    recordings = rewriting.loaded(entry, store) if entry.result is not None else None
    if recordings is not None:
        recordings = without_names(recordings, names)
    place = store.new_place()
    top = place / (STUDENTS if each.part == SUBMISSIONS else ASIDE)
    rewriting.write_entry(entry, hand_in, top / hand_in.id, recordings, names)
    store.put(entry.key if store.has(entry.key) else "", place)
    if hand_in.id != entry.id:
        store.take_out(entry.folder)
