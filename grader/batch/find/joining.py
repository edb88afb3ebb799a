"""Whose is what: attempts and a roster, brought together."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from grader.batch.find.attempt import Attempt
from grader.batch.find.roster import Member, Roster, folded
from grader.batch.hand_in import Person
from grader.submission.folder import listed, shown
from grader.text import count

NOTHING = "Nothing was handed in."


def joined(attempts: Sequence[Attempt], roster: Roster) -> tuple[list[Attempt], list[str]]:
    """The attempts with what the roster says of whose they are, and an empty one of all others.

    Somebody is known by an id, an email address, a user name, the number of a Moodle participant;
    else by a part of a repository's name; else by a name, if nobody else has it; else a whole
    group by its name.

    Returns:
        Them, and what to say.
    """
    index = _Index(roster.members)
    found, unknown, seen = [], [], set[str]()
    for attempt in attempts:
        members: list[Member | None] = list(index.group(attempt))
        people = tuple(member.person for member in members if member)
        if not people:
            members = [index.member(each, attempt.aliases) for each in attempt.people]
            people = tuple(map(_person, attempt.people, members))
        ids = [member.person.id for member in members if member]
        if not ids:
            unknown.append(attempt.people[0].name or attempt.people[0].id)
        seen.update(ids)
        whose = "+".join(sorted(each.id for each in people)) if ids else attempt.whose
        times = [member.at for member in members if member and member.at]
        at = max(times) if times else attempt.at
        found.append(replace(attempt, whose=whose, people=people, at=at))
    found += [
        Attempt(member.person.id, (member.person,), problem=NOTHING)
        for member in roster.members
        if member.person.id not in seen
    ]
    notes = list(roster.notes)
    if unknown:
        what = count(len(unknown), "hand-in")
        notes.append(f"Not in {shown(roster.name)}, and yet there: {what} ({listed(unknown)}).")
    return found, notes


#: Columns of an export that say who somebody is.
_KEYS = ("ID", "SID", "Email", "email", "Identifier")


class _Index:
    """Members by what they may be known by; what two of them have is no key."""

    def __init__(self, members: Sequence[Member]) -> None:
        self._by_key = _unique((key, member) for member in members for key in member.keys)
        named = ((name, member) for member in members for name in _orders(member.person.name))
        self._by_name = _unique(named)
        self._groups: dict[str, list[Member]] = defaultdict(list)
        for member in members:
            for group in member.groups:
                self._groups[_letters(group)].append(member)

    def member(self, person: Person, aliases: Iterable[str]) -> Member | None:
        """Who of the class somebody is."""
        columns = (person.columns[title] for title in _KEYS if title in person.columns)
        for key in (person.id, *columns, *aliases):
            member = self._by_key.get(folded(key))
            if member and not _contradicts(person, member):
                return member
        for name in filter(None, (_letters(person.name), _letters(person.id))):
            if member := self._by_name.get(name):
                return member
        return None

    def group(self, attempt: Attempt) -> Sequence[Member]:
        """Who is in the group that an attempt is of, if it is one's."""
        if len(attempt.people) > 1:
            return ()
        (whose,) = attempt.people
        return self._groups.get(_letters(whose.name or whose.id), ())


def _contradicts(found: Person, member: Member) -> bool:
    """Whether a number of Moodle's is another one: groups have such numbers, too."""
    if "Identifier" not in found.columns or not (found.name and member.person.name):
        return False
    return set(_words(found.name)).isdisjoint(_words(member.person.name))


def _words(name: str) -> list[str]:
    return re.findall(r"\w+", name.casefold())


def _person(found: Person, member: Member | None) -> Person:
    """Somebody as roster and export tell it; where they differ, as the roster does."""
    if member is None:
        return found
    own = member.person
    return Person(own.id, own.name or found.name, {**found.columns, **own.columns})


def _unique(pairs: Iterable[tuple[str, Member]]) -> dict[str, Member]:
    found: dict[str, Member | None] = {}
    for key, member in pairs:
        same = folded(key)
        found[same] = member if found.get(same, member) is member else None
    return {key: member for key, member in found.items() if key and member is not None}


def _orders(name: str) -> Iterator[str]:
    """A name as it is, and with its first part last, or the other way round."""
    yield from {_letters(name), *_turned(name)}


def _turned(name: str) -> Iterator[str]:
    last, comma, first = name.partition(",")
    if comma:
        yield _letters(first + last)
    parts = name.split()
    for at in range(1, len(parts)):
        yield _letters("".join(parts[at:] + parts[:at]))


def _letters(text: str) -> str:
    """Letters and digits alone, as Canvas writes names."""
    return re.sub(r"[\W_]+", "", text.casefold())
