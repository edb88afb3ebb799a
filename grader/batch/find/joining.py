"""Whose is what: attempts and a roster, brought together."""

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
#: Of somebody who may be one of those whose hand-ins are nobody's: to be without a grade.
UNCLEAR = msg("It is not clear which hand-in, if any, is this person's.")


def joined(
    attempts: Sequence[Attempt], roster: Roster, is_one_each: bool = False
) -> tuple[list[Attempt], list[Message]]:
    """The attempts with what the roster says of whose they are, and an empty one of all others.

    A group is known by its name; somebody by an id, an email address, a user name, the number of a
    Moodle participant, the end of a repository's name; else by a name, if nobody else has it.

    Args:
        is_one_each: whether nothing tells which of two is newer, so that both are nobody's.

    Returns:
        Them, and what to say.
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
    """The same without those of the class to whom several are matched."""
    times = Counter(member.person.id for members in matched for member in members if member)
    return [
        [each if each and times[each.person.id] == 1 else None for each in members]
        for members in matched
    ]


#: Before whose an attempt is, if the roster says so: an id of the roster's and the name of a file
#: that nobody knows may be the same text, and do not mean the same person.
_OF_ROSTER = "roster\0"


def is_of_roster(attempt: Attempt) -> bool:
    """Whether the roster says whose an attempt is."""
    return attempt.whose.startswith(_OF_ROSTER)


def _missing(member: RosterMember, is_unclear: bool) -> Attempt:
    problem = UNCLEAR if is_unclear else NOT_HANDED_IN
    return Attempt(_OF_ROSTER + member.person.id, (member.person,), problem=problem)


def _unclear(
    unknown: Sequence[Person], missing: Sequence[RosterMember], index: _Index, notes: list[Message]
) -> set[str]:
    """The ids of those missing who may be one of the unknown; it is told whom they may be."""
    found, told = set[str](), list[Message]()
    for person in unknown:
        might = index.candidates(person)
        if may_be := [member.person for member in missing if member.person.id in might]:
            found.update(each.id for each in may_be)
            names = message.joined([_called(each) for each in may_be[:3]], msg(" or "))
            who = shown(person.name or person.id)
            told.append(msg("{who} may be {names}", who=who, names=names))
    if told:
        notes.append(
            msg(
                "Ambiguous, and so nobody's: {pairs}. They have no grade in any import; "
                "make clear in the roster, or in the names of the files, who is who.",
                pairs=listed(told),
            )
        )
    return found


def _called(person: Person) -> Text:
    id = shown(person.id)
    return msg("{name} ({id})", name=shown(person.name), id=id) if person.name else id


#: Columns of an export that say who somebody is.
_KEYS = ("ID", "SID", "Email", "email", "Identifier")


def _matched(attempts: Sequence[Attempt], index: _Index) -> list[Sequence[RosterMember | None]]:
    """Who of the class each attempt is of.

    A name is one's own to choose in most systems: it counts only if no other has it, and for
    whoever is not known by something better already.
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
    taken = {member.person.id for members in sure for member in members if member}
    claims: dict[str, set[str]] = defaultdict(set)
    for attempt, members in zip(attempts, names, strict=True):
        for member in filter(None, members):
            claims[member.person.id].add(attempt.whose)
    free = {id for id, whose in claims.items() if len(whose) == 1} - taken
    for number, members in enumerate(names):
        if any(members):
            sure[number] = [each if each and each.person.id in free else None for each in members]
    return sure


def _best_alias(attempts: Sequence[Attempt], index: _Index) -> int:
    """Which of their aliases most are known by; the last if none is."""
    most = min((len(attempt.aliases) for attempt in attempts), default=0)
    known = [sum(bool(index.keyed([each.aliases[at]])) for each in attempts) for at in range(most)]
    return max(range(most), key=lambda at: (known[at], at), default=0)


class _Index:
    """Members by what they may be known by; what two of them have is no key."""

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
        """Who has the first of these keys that somebody alone has."""
        return next(filter(None, (_only(self._keys.get(folded(key))) for key in keys)), None)

    def by_key(self, person: Person) -> RosterMember | None:
        """Who somebody is, by his id or what else an export says of him but the name."""
        columns = (person.columns[title] for title in _KEYS if title in person.columns)
        member = self.keyed((person.id, *columns))
        return None if member and _contradicts(person, member) else member

    def by_name(self, person: Person) -> RosterMember | None:
        """Who somebody is, by his name; a folder's name may be one, too."""
        names = (letters(person.name), letters(person.id))
        return next(filter(None, (_only(self._names.get(name)) for name in names)), None)

    def candidates(self, person: Person) -> set[str]:
        """The ids of all who have anything in common with somebody that could be a key."""
        columns = (person.columns[title] for title in _KEYS if title in person.columns)
        keys = [] if "Identifier" in person.columns else [person.id, *columns]
        texts = {*map(folded, keys), letters(person.name), letters(person.id)} - {""}
        found = ((*self._keys.get(text, ()), *self._names.get(text, ())) for text in texts)
        return {member.person.id for members in found for member in members}

    def group(self, attempt: Attempt) -> Sequence[RosterMember]:
        """Who is in the group that an attempt is of, if it is one's."""
        if len(attempt.people) > 1:
            return ()
        (whose,) = attempt.people
        return self._groups.get(letters(whose.name or whose.id), ())


def _contradicts(found: Person, member: RosterMember) -> bool:
    """Whether a number of Moodle's is another one: groups have such numbers, too."""
    if "Identifier" not in found.columns or not (found.name and member.person.name):
        return False
    return set(_words(found.name)).isdisjoint(_words(member.person.name))


def _words(name: str) -> list[str]:
    return re.findall(r"\w+", name.casefold())


def _person(found: Person, member: RosterMember | None) -> Person:
    """Somebody as roster and export tell it; where they differ, as the roster does."""
    if member is None:
        return found
    own = member.person
    return Person(own.id, own.name or found.name, {**found.columns, **own.columns})


def _only(members: Sequence[RosterMember] | None) -> RosterMember | None:
    return members[0] if members and len(members) == 1 else None


def _orders(name: str) -> Iterator[str]:
    """A name as it is, and with its first part last, or the other way round."""
    yield letters(name)
    last, comma, first = name.partition(",")
    if comma:
        yield letters(first + last)
    parts = name.split()
    for at in range(1, len(parts)):
        yield letters("".join(parts[at:] + parts[:at]))
