"""Find the student to be forgotten, and all hand-ins that are kept of a class."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from grader.batch.entry import SUBMISSIONS, Entry, HandIn, Person
from grader.batch.names.people import forms, names_of, of_all, said_in
from grader.batch.names.replacing import LITERAL, Names
from grader.batch.names.spelling import composed, folded
from grader.batch.similar.sources import SOURCE
from grader.batch.store import ASIDE, BEFORE
from grader.errors import UsageError
from grader.message import Message, Text, joined

#: Stands for the name of one who is forgotten.
FORGOTTEN = "forgotten"
_MOST_SHOWN = 8


@dataclass(frozen=True)
class Kept:
    """A hand-in that is kept.

    Attributes:
        part: of the class's folder: `submissions`, `aside`, `before/1/submissions`.
    """

    entry: Entry
    part: str

    @property
    def is_older(self) -> bool:
        """Whether a regrade has replaced it."""
        return self.part not in (SUBMISSIONS, ASIDE)


@dataclass(frozen=True)
class Whom:
    """A student to be forgotten.

    Attributes:
        person: as the newest hand-in knows them.
        names: replaces them.
        names_of_run: the same in runs of hand-ins that are theirs alone, which others may share:
            also what these say of their authors.
        keys: of these runs.
        shared: parts of their names that others of the class have too; these stay.
    """

    person: Person
    names: Names
    names_of_run: Names
    keys: frozenset[str]
    shared: tuple[str, ...]

    def is_in(self, entry: Entry) -> bool:
        """Whether they are among those of a hand-in."""
        return any(person.id == self.person.id for person in entry.hand_in.people)

    def names_for(self, key: str) -> Names:
        """Return what replaces their names in a run."""
        return self.names_of_run if key in self.keys else self.names

    def is_alone_in(self, entry: Entry) -> bool:
        """Whether a hand-in is theirs and nobody else's."""
        return self.is_in(entry) and not self.others(entry)

    def without(self, hand_in: HandIn) -> HandIn:
        """Return a hand-in of others whose texts do not have their names."""
        people = (
            replace(each, columns={title: self.names(v) for title, v in each.columns.items()})
            for each in hand_in.people
        )
        return replace(
            hand_in,
            people=tuple(people),
            filename=self.names(hand_in.filename),
            problem=hand_in.problem.map_texts(self.names),
        )

    def others(self, entry: Entry) -> tuple[Person, ...]:
        """Return the other people of a hand-in."""
        return tuple(person for person in entry.hand_in.people if person.id != self.person.id)


def all_kept(out: Path) -> list[Kept]:
    """Return all hand-ins that are kept of a class, those of the class itself first."""
    return list(_kept(out))


def _kept(out: Path) -> Iterator[Kept]:
    parts = [SUBMISSIONS, ASIDE]
    parts += [f"{BEFORE}/{at.name}/{SUBMISSIONS}" for at in sorted((out / BEFORE).glob("*/"))]
    for part in parts:
        for folder in sorted((out / part).glob("*/")):
            try:
                yield Kept(Entry.read(folder), part)
            except UsageError:
                continue  # it cannot be told whose it is; a search at the end finds names in it


def find(
    student: str,
    kept: Sequence[Kept],
    known: frozenset[str],
    also: Sequence[str] = (),
    typed: str = "",
) -> Whom:
    """Find a student by id, name, address, or the id of a hand-in of theirs alone.

    Args:
        known: words that do not count by themselves; see `grader.batch.names.people.known_words`.
        also: other names of the student.
        typed: what `student` was computed from, if it was.

    Raises:
        UsageError: there is no such student, or there are several.
    """
    people: dict[str, Person] = {}
    called: dict[str, set[str]] = {}
    for entry in (each.entry for each in kept):
        for person in entry.hand_in.people:
            people.setdefault(person.id, person)
            texts = called.setdefault(person.id, set())
            texts.update(names_of(person))
            if len(entry.hand_in.people) == 1:
                texts.add(entry.id)
    id = _chosen(student, people, called, typed)
    called[id].update(also)
    return _whom(id, people, called, kept, known)


def _chosen(
    student: str, people: dict[str, Person], called: dict[str, set[str]], typed: str
) -> str:
    wanted = composed(student)
    by_id = [id for id in people if composed(id) == wanted]
    exactly = [id for id, texts in called.items() if wanted in map(composed, texts)]
    loosely = [id for id, texts in called.items() if folded(student) in map(folded, texts)]
    found = next(filter(None, (by_id, exactly, loosely)), [])
    if len(found) == 1:
        return found[0]
    if found:
        raise UsageError(
            "{student} may be several students: {who}. Give the id. Nothing was changed.",
            student=student,
            who=_listed(people, found),
        )
    near = [] if typed else _near(student, called)
    if not near:
        raise UsageError(
            "{student} is nobody in this class. Nothing was changed.", student=typed or student
        )
    raise UsageError(
        "{student} is nobody in this class; similar are: {who}. Nothing was changed.",
        student=student,
        who=_listed(people, near),
    )


def _near(student: str, called: dict[str, set[str]]) -> list[str]:
    """Return the ids of those whose names are alike, or have a part of what was asked for."""
    wanted = folded(student)
    by_text = {folded(text): id for id, texts in called.items() for text in texts}
    close = difflib.get_close_matches(wanted, by_text, _MOST_SHOWN, 0.7)
    within = [text for text in by_text if wanted and wanted in text]
    return list(dict.fromkeys(by_text[text] for text in (*close, *within)))


def _listed(people: dict[str, Person], ids: Sequence[str]) -> Message:
    shown: list[Text] = []
    for person in (people[id] for id in ids[:_MOST_SHOWN]):
        shown.append(f"{person.id} ({person.name})" if person.name else person.id)
    return joined([*shown, "…"] if len(ids) > _MOST_SHOWN else shown, ", ")


def _whom(
    id: str,
    people: dict[str, Person],
    called: dict[str, set[str]],
    kept: Sequence[Kept],
    known: frozenset[str],
) -> Whom:
    said, keys = list[str](), set[str]()
    for entry in (each.entry for each in kept):
        if [person.id for person in entry.hand_in.people] == [id]:
            said += said_in(entry.folder / SOURCE)
            keys.add(entry.key)
    others = of_all({one: called[one] for one in people if one != id}, known, FORGOTTEN)
    own = forms(sorted(called[id]), FORGOTTEN, known)
    names = {name: stands for name, stands in own.items() if name not in others}
    told = forms(dict.fromkeys(said), f"{FORGOTTEN}y", known)
    told = {name: stands for name, stands in told.items() if name not in others}
    return Whom(
        people[id],
        Names({}, names, known=known),
        Names({}, told | names, known=known),
        frozenset(keys - {""}),
        tuple(sorted(name.removeprefix(LITERAL) for name in own.keys() & others.keys())),
    )
