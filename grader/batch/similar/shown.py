"""What the page shows of a class: sentences, without any HTML."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from grader import text
from grader.batch.entry import Entry
from grader.batch.similar.compare import Look, Pair
from grader.language.phrase import say
from grader.language.telling import tell

_LONGEST_NAME: Final = 100


@dataclass(frozen=True)
class Class:
    """A class, and what was found in it.

    Attributes:
        entries: whoever handed in something.
        look: what was found; its numbers are places in `entries`.
        only_given: numbers of those who handed in nothing but what everybody was given.
        numbers: of each id, what stands for it where names are hidden, as on the class's page; no
            order of names or ids tells it.
    """

    entries: tuple[Entry, ...]
    look: Look
    only_given: tuple[int, ...]
    numbers: Mapping[str, int]


@dataclass(frozen=True)
class Person:
    """Whose a hand-in is: a number that hides it, an id, a name, a file to go to ('' for none)."""

    number: int
    id: str
    name: str
    report: str


@dataclass(frozen=True)
class Fact:
    """In which respect two are alike: how, and how usual that is in the class."""

    what: str
    how: str
    usual: str


@dataclass(frozen=True)
class Shown:
    """A pair as the page shows it."""

    pair: Pair
    headline: str
    facts: tuple[Fact, ...]
    one: Person
    other: Person


def person(found: Class, who: int) -> Person:
    """Whose a hand-in is."""
    entry = found.entries[who]
    name = text.clip(text.one_line(text.plain(entry.hand_in.name)), _LONGEST_NAME)
    report = f"submissions/{entry.id}/report.html" if entry.result is not None else ""
    return Person(found.numbers[entry.id], entry.id, name, report)


def shown(found: Class) -> Iterator[Shown]:
    """The pairs, the least likely ones first."""
    for pair in found.look.pairs:
        facts = tuple(_facts(len(found.entries), pair))
        one, other = person(found, pair.first), person(found, pair.second)
        yield Shown(pair, _headline(pair), facts, one, other)


def _headline(pair: Pair) -> str:
    if pair.same_content:
        return tell("the same files, byte for byte")
    return tell("the same behaviour")


def _facts(size: int, pair: Pair) -> Iterator[Fact]:
    if pair.same_content:
        same = tell("The Python files are the same, byte for byte.")
        yield Fact(tell("What was handed in"), same, "")
    how = tell(
        "{share} of them are equal, tick by tick; the first {ticks:,} ticks are the same.",
        share=_percent(pair.equal_commands),
        ticks=pair.equal_ticks,
    )
    usual = tell("As a whole they are not alike.")
    if pair.commands_hands:
        usual = _hands(size, pair.commands_hands, say("send such commands"))
    yield Fact(tell("Commands"), how, usual)
    if pair.path_mm is not None:
        how = tell("{m:.3f} m apart, as a mean along the way.", m=pair.path_mm / 1000)
        usual = _hands(size, pair.path_hands, say("went as near one of the two"))
        yield Fact(tell("Way"), how, usual)


def _hands(size: int, hands: int, what: str) -> str:
    if hands <= 2:
        return tell("Of {size:,} hand-ins no others {what}.", size=size, what=what)
    return tell(
        "Of {size:,} hand-ins {hands:,} {what}, these two among them.",
        size=size,
        hands=hands,
        what=what,
    )


def _percent(share: float) -> str:
    """A share as people write it: 100 % is all of it, and 0 % nothing."""
    value = f"{100 * share:.0f}"
    if float(value) >= 100 and share < 1:
        return tell("more than {share} %", share="99")
    if share and not float(value):
        return tell("less than {share} %", share="1")
    return tell("{share} %", share=value)
