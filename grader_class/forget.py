"""Forget a student: remove what only the student has of a class, and make its outputs anew.

A run that others share stays with them; so does a group's hand-in, without this member. What files
of others say of the student stays as well: nothing is searched. The student's own folders go last:
where a call is cut off, the same one finds the student again, and does the rest.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path

from grader import Exercise, UsageError
from grader.exercise import View
from grader.reports import Artifacts, Report, render
from grader.system import files, remove
from grader.text import listed, nearest
from grader_class import batch
from grader_class.class_file import ClassFile
from grader_class.entry import SUBMISSIONS, Entry, HandIn, Person, comparable, entries, id_of
from grader_class.find.newest import safe_id
from grader_class.regrade import CHANGES
from grader_class.store import ASIDE, Store, link


@dataclass(frozen=True)
class Plan:
    """What is to be done.

    Attributes:
        goes: folders: hand-ins of the student alone, and runs that nobody else has.
        groups: hand-ins of groups, and what they are without the student.
        remaining: the class afterwards.
    """

    person: Person
    goes: tuple[Path, ...]
    groups: tuple[tuple[Entry, HandIn], ...]
    remaining: tuple[Entry, ...]


def plan(store: Store, student: str) -> Plan:
    """Plan what is to be done; nothing is changed.

    Args:
        student: an id, a name or an address; in a class under pseudonyms the pseudonym.
    """
    kept = [*entries(store.out), *entries(store.out, ASIDE)]
    person = _find(student, kept)
    theirs = [each for each in kept if any(p.id == person.id for p in each.hand_in.people)]
    own = [each for each in theirs if len(each.hand_in.people) == 1]
    groups = [(each, _without(person, each)) for each in theirs if each not in own]
    keys = {each.key for each in own} - {each.key for each in kept if each not in own}
    runs = [store.run(key) for key in sorted(keys) if store.has(key)]
    hand_ins = [each.folder for each in own]
    now = {each.folder: hand_in for each, hand_in in groups}
    # beside a group may be what a call that was cut off has made of it
    gone = {*hand_ins, *(folder.with_name(hand_in.id) for folder, hand_in in now.items())}
    there = [e for e in kept if e.folder.parent.name == SUBMISSIONS and e.folder not in gone]
    remaining = [_as(each, now.get(each.folder, each.hand_in)) for each in there]
    remaining.sort(key=lambda entry: entry.id)
    return Plan(person, (*runs, *hand_ins), tuple(groups), tuple(remaining))


def carry_out(made: Plan, store: Store, exercise: Exercise, view: View, assignment: str) -> None:
    """Do what is planned; `view` and `assignment` are those of `batch.write_outputs`."""
    batch.write_outputs(store.out, made.remaining, exercise, view, assignment)
    replace(ClassFile.read(store.out), hand_ins=len(made.remaining)).put(store.out)
    files.clear(store.out / CHANGES)  # has the student's row; a regrade makes it anew
    for folder in made.goes:
        store.take_out(folder)
    for entry, hand_in in made.groups:
        _rename(entry, hand_in, store)


def _find(student: str, kept: Sequence[Entry]) -> Person:
    # the class comes first, and knows a person better than what was set aside
    people = {p.id: p for entry in reversed(kept) for p in entry.hand_in.people}
    called = {id: _called(person) for id, person in people.items()}
    wanted = comparable(student)
    ids = [id for id in people if comparable(id) == wanted]
    ids = ids or [id for id, texts in called.items() if wanted in texts]
    if len(ids) == 1:
        return people[ids[0]]
    like = nearest(wanted, {text for texts in called.values() for text in texts})
    ids = ids or [id for id, texts in called.items() if texts & {*like}]
    if not ids:
        raise UsageError(
            "{student} is nobody in this class; in one under pseudonyms, give the student's. "
            "Nothing was changed.",
            student=student,
        )
    raise UsageError(
        "{student} is not one student of this class. Give the id, if it is one of these: {who}. "
        "Nothing was changed.",
        student=student,
        who=listed(f"{id} {people[id].name}".strip() for id in ids),
    )


def _called(person: Person) -> set[str]:
    """Return the id, the name and the addresses of a person, to be compared."""
    addresses = [cell for cell in person.columns.values() if "@" in cell]
    return {comparable(text) for text in (person.id, person.name, *addresses) if text}


def _without(person: Person, entry: Entry) -> HandIn:
    """Return a group's hand-in without a member, under an id that nobody else has."""
    people = tuple(each for each in entry.hand_in.people if each.id != person.id)
    wanted = safe_id(id_of([each.id for each in people]))
    ids = (f"{wanted}-{number}" if number > 1 else wanted for number in count(1))
    possible = (replace(entry.hand_in, id=id, people=people) for id in ids)
    return next(each for each in possible if _is_free(entry.folder.with_name(each.id), each))


def _is_free(folder: Path, hand_in: HandIn) -> bool:
    """Whether a hand-in may have a folder; a call that was cut off may have made just this one."""
    try:
        return not os.path.lexists(folder) or Entry.read(folder).hand_in == hand_in
    except UsageError:
        return False


def _as(entry: Entry, hand_in: HandIn) -> Entry:
    """Return an entry as that of another hand-in: with its id and people."""
    result = entry.result
    if result is not None:
        whose = result.handed_in and replace(result.handed_in, id=hand_in.id, name=hand_in.name)
        result = replace(result, submission=hand_in.name, handed_in=whose)
    return replace(entry, hand_in=hand_in, result=result)


def _rename(entry: Entry, hand_in: HandIn, store: Store) -> None:
    """Make the folder of a hand-in that of another one; its run stays."""
    made = store.new_place() / hand_in.id
    target = entry.folder.with_name(hand_in.id)
    with files.writing(target):
        shutil.copytree(entry.folder, made, symlinks=True, copy_function=link)
        named = replace(_as(entry, hand_in), folder=made)
        if named.result is not None:
            named.result.put(made)
            report = Report(named.result, Artifacts(named.result, made), "whole")
            files.put(made / named.result.PAGE, render("html", [report]).encode("utf-8"))
        named.put()
        remove(target)
        made.rename(target)
    store.take_out(entry.folder)
