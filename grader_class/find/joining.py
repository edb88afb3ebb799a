"""Match attempts with the members of a roster: by ids, addresses and exact names."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain

from grader.text import Message, listed, msg, shown
from grader_class.entry import Person, comparable
from grader_class.find.attempt import Attempt
from grader_class.find.roster import Roster, RosterMember, letters

NOT_HANDED_IN = msg("Nothing was handed in.")
#: The problem of a member to whom an unmatched hand-in may belong: there is no grade.
UNCLEAR = msg("It is not clear which hand-in, if any, is this person's.")
NOT_CLEAR = msg(
    "It is not clear which hand-in is theirs: {people}. They have no grade in any import; make "
    "clear in the roster, or in the names of the files, who is who."
)
#: Columns of an export that identify a person.
_KEYS = ("ID", "SID", "Email", "email", "Identifier")
#: Prefix of `Attempt.whose` for members of the roster: an id in the roster and the name of an
#: unknown file may be the same text, but are not the same person.
_OF_ROSTER = "roster\0"


def joined(attempts: Sequence[Attempt], roster: Roster) -> tuple[list[Attempt], list[Message]]:
    """Return the attempts with their members, an empty one of each other member, and notes.

    A group is matched by its name; a person by an id, an email address, a user name, the number of
    a Moodle participant, the end of a repository's name; else by a name, if nobody else has it.
    """
    index = _Index(roster.members)
    matched, ambiguous = _matched(attempts, index)
    found, unknown, seen = [], list[Person](), set[str]()
    for attempt, members in zip(attempts, matched, strict=True):
        people = tuple(member.person for member in members if member)
        if not index.group(attempt):
            people = tuple(map(_merged, attempt.people, members))
            pairs = zip(attempt.people, members, strict=True)
            unknown += [person for person, member in pairs if member is None]
        if known := [member for member in members if member]:
            seen.update(member.id for member in known)
            whose = _OF_ROSTER + "+".join(sorted(each.id for each in people))
            at = max((member.at for member in known if member.at), default=attempt.at)
            attempt = replace(attempt, whose=whose, people=people, at=at)
        found.append(attempt)
    missing = [member.person for member in roster.members if member.id not in seen]
    for person in missing:
        problem = UNCLEAR if person.id in ambiguous else NOT_HANDED_IN
        found.append(Attempt(_OF_ROSTER + person.id, (person,), problem=problem))
    notes = [*roster.notes]
    if unknown:
        notes.append(
            msg(
                "Not in {roster}, and yet there: {names}.",
                roster=shown(roster.name),
                names=listed(person.name or person.id for person in unknown),
            )
        )
    if unclear := [person for person in missing if person.id in ambiguous]:
        who = listed(f"{person.name} ({person.id})".strip() for person in unclear)
        notes.append(NOT_CLEAR.given(people=who))
    return found, notes


def is_of_roster(attempt: Attempt) -> bool:
    """Whether an attempt belongs to a member of the roster."""
    return attempt.whose.startswith(_OF_ROSTER)


def _matched(
    attempts: Sequence[Attempt], index: _Index
) -> tuple[list[Sequence[RosterMember | None]], set[str]]:
    """Return the members whom each attempt belongs to, and the ids of those whose is ambiguous.

    A person whom the roster does not have is None. Students choose their names in most systems: a
    name counts only for members whom nothing better matches. Who matches the attempts of several is
    nobody's, unless times put them into an order.
    """
    options = [
        [index.options(each, attempt.keys) for each in attempt.people] for attempt in attempts
    ]
    by_key = {one[0].id for each in options for one, is_key in each if is_key and len(one) == 1}
    matched = list[Sequence[RosterMember | None]]()
    claims: dict[str, set[str]] = defaultdict(set)
    unordered, ambiguous = set[str](), set[str]()
    for attempt, each in zip(attempts, options, strict=True):
        members: list[RosterMember | None] = [*index.group(attempt)]
        for one, is_key in each if not members else ():
            is_sure = len(one) == 1 and (is_key or one[0].id not in by_key)
            members.append(one[0] if is_sure else None)
            ambiguous.update(member.id for member in one if not is_sure)
        for member in filter(None, members):
            claims[member.id].add(attempt.whose)
            if attempt.at is None or member.id not in by_key:
                unordered.add(member.id)
        matched.append(members)
    several = {id for id, whose in claims.items() if len(whose) > 1} & unordered
    kept = [
        [each if each and each.id not in several else None for each in members]
        for members in matched
    ]
    return list(kept), ambiguous | several


class _Index:
    """Members by their keys, names and groups."""

    def __init__(self, members: Sequence[RosterMember]) -> None:
        self._keys: dict[str, list[RosterMember]] = defaultdict(list)
        self._names: dict[str, list[RosterMember]] = defaultdict(list)
        self._groups: dict[str, list[RosterMember]] = defaultdict(list)
        for member in members:
            for key in {*map(comparable, member.keys)} - {""}:
                self._keys[key].append(member)
            if name := letters(member.person.name):
                self._names[name].append(member)
            for group in member.groups:
                self._groups[letters(group)].append(member)

    def options(self, person: Person, keys: Sequence[str]) -> tuple[list[RosterMember], bool]:
        """Return the members that a person may be, and whether ids or addresses say so.

        Args:
            keys: what may identify the person; (): the id and the columns.
        """
        keys = keys or (person.id, *(person.columns.get(title, "") for title in _KEYS))
        found = [self._keys[key] for key in map(comparable, keys) if key in self._keys]
        found = [each for each in found if not _contradicts(person, each[0])]
        named = self._names.get(letters(person.name or person.id), [])
        one = next((each for each in found if len(each) == 1), None)
        if one is None and len(named) == 1:
            return named, False
        return one or [*chain(*found), *named], one is not None

    def group(self, attempt: Attempt) -> Sequence[RosterMember]:
        """Return the members of the group that handed in an attempt; empty if it is no group's."""
        if len(attempt.people) > 1:
            return ()
        (whose,) = attempt.people
        return self._groups.get(letters(whose.name or whose.id), ())


def _contradicts(person: Person, member: RosterMember) -> bool:
    """Whether names show that a Moodle number is not this member's, but perhaps a group's."""
    names = letters(person.name), letters(member.person.name)
    return "Identifier" in person.columns and all(names) and names[0] != names[1]


def _merged(person: Person, member: RosterMember | None) -> Person:
    """Merge a person of the export with a member; where they differ, the roster counts."""
    if member is None:
        return person
    known = member.person
    return Person(known.id, known.name or person.name, {**person.columns, **known.columns})
