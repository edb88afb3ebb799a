"""Match attempts with the members of a roster."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from grader import message
from grader.batch.entry import Person
from grader.batch.find.attempt import Attempt
from grader.batch.find.roster import Roster, RosterMember, folded, letters
from grader.message import Message, Text, msg
from grader.submission.folder import listed, shown

NOT_HANDED_IN = msg("Nothing was handed in.")
#: The problem of a member to whom an unmatched hand-in may belong: there is no grade.
UNCLEAR = msg("It is not clear which hand-in, if any, is this person's.")


def joined(
    attempts: Sequence[Attempt], roster: Roster, is_one_each: bool = False
) -> tuple[list[Attempt], list[Message]]:
    """Return the attempts with their members, an empty one of each other member, and notes.

    A group is matched by its name; a person by an id, an email address, a user name, the number of
    a Moodle participant, the end of a repository's name; else by a name, if nobody else has it.

    Args:
        is_one_each: whether two attempts of a person cannot be ordered, so that none is matched.
    """
    index = _Index(roster.members)
    matched = _matched(attempts, index)
    if is_one_each:
        matched = _without_several(matched)
    found, unknown, seen = [], list[Person](), set[str]()
    for attempt, members in zip(attempts, matched, strict=True):
        known = [member for member in members if member]
        people = tuple(member.person for member in known)
        if not index.group(attempt):
            people = tuple(map(_person, attempt.people, members))
            pairs = zip(attempt.people, members, strict=True)
            unknown += [person for person, member in pairs if member is None]
        if not known:
            found.append(attempt)
            continue
        seen.update(member.person.id for member in known)
        whose = _OF_ROSTER + "+".join(sorted(each.id for each in people))
        at = max((member.at for member in known if member.at), default=attempt.at)
        found.append(replace(attempt, whose=whose, people=people, at=at))
    missing = [member for member in roster.members if member.person.id not in seen]
    notes = [*roster.notes]
    if unknown:
        notes.append(
            msg(
                "Not in {roster}, and yet there: {names}.",
                roster=shown(roster.name),
                names=listed(person.name or person.id for person in unknown),
            )
        )
    unclear = _unclear(unknown, missing, index, notes)
    found += [_missing(member, member.person.id in unclear) for member in missing]
    return found, notes


def _without_several(
    matched: Sequence[Sequence[RosterMember | None]],
) -> list[Sequence[RosterMember | None]]:
    """Remove the matches of members who match several attempts."""
    times = Counter(member.person.id for members in matched for member in members if member)
    return [
        [each if each and times[each.person.id] == 1 else None for each in members]
        for members in matched
    ]


#: Prefix of `Attempt.whose` for members of the roster: an id in the roster and the name of an
#: unknown file may be the same text, but are not the same person.
_OF_ROSTER = "roster\0"


def is_of_roster(attempt: Attempt) -> bool:
    """Whether an attempt belongs to a member of the roster."""
    return attempt.whose.startswith(_OF_ROSTER)


def _missing(member: RosterMember, is_unclear: bool) -> Attempt:
    problem = UNCLEAR if is_unclear else NOT_HANDED_IN
    return Attempt(_OF_ROSTER + member.person.id, (member.person,), problem=problem)


def _unclear(
    unknown: Sequence[Person], missing: Sequence[RosterMember], index: _Index, notes: list[Message]
) -> set[str]:
    """Return the ids of the missing who may be one of the unknown, and add a note on them."""
    found, pairs = set[str](), list[Message]()
    for person in unknown:
        might = index.candidates(person)
        if may_be := [member.person for member in missing if member.person.id in might]:
            found.update(each.id for each in may_be)
            names = message.joined([_called(each) for each in may_be[:3]], msg(" or "))
            who = shown(person.name or person.id)
            pairs.append(msg("{who} may be {names}", who=who, names=names))
    if pairs:
        notes.append(
            msg(
                "Ambiguous, and so nobody's: {pairs}. They have no grade in any import; "
                "make clear in the roster, or in the names of the files, who is who.",
                pairs=listed(pairs),
            )
        )
    return found


def _called(person: Person) -> Text:
    id = shown(person.id)
    return msg("{name} ({id})", name=shown(person.name), id=id) if person.name else id


#: Columns of an export that identify a person.
_KEYS = ("ID", "SID", "Email", "email", "Identifier")


def _matched(attempts: Sequence[Attempt], index: _Index) -> list[Sequence[RosterMember | None]]:
    """Return the members whom each attempt belongs to; None for an unknown person.

    Students choose their names in most systems: a name counts only if no other has it, and only for
    members who are not matched by something better.
    """
    alias = _best_alias(attempts, index)
    sure: list[Sequence[RosterMember | None]] = []
    for attempt in attempts:
        group = index.group(attempt)
        if group or not attempt.aliases:
            sure.append(group or [index.by_key(person) for person in attempt.people])
        else:
            sure.append([index.keyed(attempt.aliases[alias : alias + 1])])
    names = [
        [None] if any(members) else [index.by_name(person) for person in attempt.people]
        for attempt, members in zip(attempts, sure, strict=True)
    ]
    matched = {member.person.id for members in sure for member in members if member}
    claims: dict[str, set[str]] = defaultdict(set)
    for attempt, members in zip(attempts, names, strict=True):
        for member in filter(None, members):
            claims[member.person.id].add(attempt.whose)
    free = {id for id, whose in claims.items() if len(whose) == 1} - matched
    for number, members in enumerate(names):
        if any(members):
            sure[number] = [each if each and each.person.id in free else None for each in members]
    return sure


def _best_alias(attempts: Sequence[Attempt], index: _Index) -> int:
    """Return which alias the most attempts are known by; the last if there is none."""
    most = min((len(attempt.aliases) for attempt in attempts), default=0)
    known = [sum(bool(index.keyed([each.aliases[at]])) for each in attempts) for at in range(most)]
    return max(range(most), key=lambda at: (known[at], at), default=0)


class _Index:
    """Members by their keys, names and groups; what two members share is no key."""

    def __init__(self, members: Sequence[RosterMember]) -> None:
        self._keys: dict[str, list[RosterMember]] = defaultdict(list)
        self._names: dict[str, list[RosterMember]] = defaultdict(list)
        self._groups: dict[str, list[RosterMember]] = defaultdict(list)
        for member in members:
            for key in {*map(folded, member.keys)} - {""}:
                self._keys[key].append(member)
            for name in {*_orders(member.person.name)} - {""}:
                self._names[name].append(member)
            for group in member.groups:
                self._groups[letters(group)].append(member)

    def keyed(self, keys: Iterable[str]) -> RosterMember | None:
        """Return the member with the first of these keys that only one member has."""
        return next(filter(None, (_only(self._keys.get(folded(key))) for key in keys)), None)

    def by_key(self, person: Person) -> RosterMember | None:
        """Return the member whom a person's id or other columns identify, except the name."""
        columns = (person.columns[title] for title in _KEYS if title in person.columns)
        member = self.keyed((person.id, *columns))
        return None if member and _contradicts(person, member) else member

    def by_name(self, person: Person) -> RosterMember | None:
        """Return the member with a person's name; the name of a folder may be one, too."""
        names = (letters(person.name), letters(person.id))
        return next(filter(None, (_only(self._names.get(name)) for name in names)), None)

    def candidates(self, person: Person) -> set[str]:
        """Return the ids of all members who share a possible key with a person."""
        columns = (person.columns[title] for title in _KEYS if title in person.columns)
        keys = [] if "Identifier" in person.columns else [person.id, *columns]
        texts = {*map(folded, keys), letters(person.name), letters(person.id)} - {""}
        found = ((*self._keys.get(text, ()), *self._names.get(text, ())) for text in texts)
        return {member.person.id for members in found for member in members}

    def group(self, attempt: Attempt) -> Sequence[RosterMember]:
        """Return the members of the group that handed in an attempt; empty if it is no group's."""
        if len(attempt.people) > 1:
            return ()
        (whose,) = attempt.people
        return self._groups.get(letters(whose.name or whose.id), ())


def _contradicts(found: Person, member: RosterMember) -> bool:
    """Whether names show that a Moodle number is not this member's, but perhaps a group's."""
    if "Identifier" not in found.columns or not (found.name and member.person.name):
        return False
    return set(_words(found.name)).isdisjoint(_words(member.person.name))


def _words(name: str) -> list[str]:
    return re.findall(r"\w+", name.casefold())


def _person(found: Person, member: RosterMember | None) -> Person:
    """Merge a person of the export with a member; where they differ, the roster counts."""
    if member is None:
        return found
    known = member.person
    return Person(known.id, known.name or found.name, {**found.columns, **known.columns})


def _only(members: Sequence[RosterMember] | None) -> RosterMember | None:
    return members[0] if members and len(members) == 1 else None


def _orders(name: str) -> Iterator[str]:
    """Yield a name, and its parts in the other possible orders."""
    yield letters(name)
    last, comma, first = name.partition(",")
    if comma:
        yield letters(first + last)
    parts = name.split()
    for at in range(1, len(parts)):
        yield letters("".join(parts[at:] + parts[:at]))
