"""What the page shows of a class: sentences and sources, without any HTML."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from grader import text
from grader.batch.entry import Entry
from grader.batch.similar.pair import Likeness, Look, Pair
from grader.batch.similar.passages import Line, Passage, Place, lines, passages
from grader.batch.similar.signature import Signature
from grader.batch.similar.sources import SOURCE, kept
from grader.language.phrase import say
from grader.language.telling import number, tell, tell_many

#: Pairs that are shown with their sources, and the lines of all these together.
MOST_SHOWN: Final = 300
MOST_LINES: Final = 60_000
_LONGEST_NAME: Final = 100


@dataclass(frozen=True)
class Class:
    """A class, and what was found in it.

    Attributes:
        entries: whoever handed in something.
        signatures: theirs, None where there is none.
        given: fingerprints of what everybody was given.
        look: what was found; its numbers are places in `entries`.
        numbers: of each id, what stands for it where names are hidden, as on the class's page; no
            order of names or ids tells it.
    """

    entries: tuple[Entry, ...]
    signatures: tuple[Signature | None, ...]
    given: frozenset[int]
    look: Look
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
class Side:
    """One of two: whose, and its files with their lines."""

    person: Person
    files: Mapping[str, list[Line]]


@dataclass(frozen=True)
class Shown:
    """A pair as the page shows it; without sources where there were too many before it."""

    pair: Pair
    headline: str
    facts: tuple[Fact, ...]
    one: Side
    other: Side
    passages: tuple[Passage, ...]


def person(found: Class, who: int) -> Person:
    """Whose a hand-in is."""
    entry = found.entries[who]
    name = text.clip(text.one_line(text.plain(entry.hand_in.name)), _LONGEST_NAME)
    report = f"submissions/{entry.id}/report.html" if entry.result is not None else ""
    return Person(found.numbers[entry.id], entry.id, name, report)


def shown(found: Class) -> Iterator[Shown]:
    """The pairs, the least likely ones first."""
    left = MOST_LINES
    for rank, pair in enumerate(found.look.pairs):
        is_shown = rank < MOST_SHOWN and left > 0
        common = _passages(found, pair) if is_shown else []
        one = _side(found, pair.first, [each.one for each in common], is_shown)
        other = _side(found, pair.second, [each.other for each in common], is_shown)
        left -= sum(len(each) for side in (one, other) for each in side.files.values())
        facts = tuple(_facts(found.look, len(found.entries), pair))
        yield Shown(pair, _headline(pair), facts, one, other, tuple(common))


def _passages(found: Class, pair: Pair) -> list[Passage]:
    one, other = found.signatures[pair.first], found.signatures[pair.second]
    if one is None or other is None:
        return []
    return passages(one, other, found.given, found.look.source_index)


def _side(found: Class, who: int, places: list[Place], is_shown: bool) -> Side:
    signature = found.signatures[who]
    whose = person(found, who)
    if signature is None or not is_shown:
        return Side(whose, {})
    names = [file.name for file in signature.files]
    try:
        files = kept(found.entries[who].folder / SOURCE)
    except OSError:
        files = []
    return Side(whose, lines(names, files, places))


def _headline(pair: Pair) -> str:
    if pair.same_content:
        return tell("the same files, byte for byte")
    if pair.source is not None:
        return tell("{share} of the sources alike", share=percent(pair.source.share))
    return tell("the same behaviour")


def _facts(look: Look, size: int, pair: Pair) -> Iterator[Fact]:
    if pair.same_content:
        same = tell("The Python files are the same, byte for byte.")
        yield Fact(tell("What was handed in"), same, "")
    if pair.source is not None:
        like = pair.source
        how = tell_many(
            "{shorter} of the shorter one, {longer} of the longer one, by weight: {n:,} "
            "fingerprint in common beside what everybody was given.",
            "{shorter} of the shorter one, {longer} of the longer one, by weight: {n:,} "
            "fingerprints in common beside what everybody was given.",
            like.count,
            shorter=percent(like.share),
            longer=percent(like.share_of_both),
        )
        yield Fact(tell("Sources"), how, _usual(look, like))
    how = tell(
        "{share} of them are equal, tick by tick; the first {ticks:,} ticks are the same.",
        share=percent(pair.equal_commands),
        ticks=pair.equal_ticks,
    )
    usual = tell("As a whole they are not alike.")
    if pair.commands:
        usual = _hands(size, pair.commands.hands, say("send such commands"))
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


def _usual(look: Look, like: Likeness) -> str:
    said = _of_all(look, like.pairs)
    if like.pairs == 1:
        return said
    if not like.outside:
        return tell("{said} All of them are in this group.", said=said)
    return tell(
        "{said} {outside:,} of them are outside of this group.", said=said, outside=like.outside
    )


def _of_all(look: Look, pairs: int) -> str:
    total = look.pairs_in_all
    if pairs <= 1:
        return tell("Of {total:,} pairs in this class no other is as similar or more.", total=total)
    return tell(
        "Of {total:,} pairs in this class {pairs:,} are as similar or more, this one among them "
        "({share}).",
        total=total,
        pairs=pairs,
        share=percent(pairs / total, 2),
    )


def percent(share: float, digits: int = 0) -> str:
    """A share as people write it; what is not all of it is never 100 %."""
    value = f"{100 * share:.{digits}f}"
    if float(value) >= 100 and share < 1:
        return tell("more than {share} %", share="99")
    if share and not float(value):
        return tell("less than {share} %", share=number(f"{10**-digits:g}"))
    return tell("{share} %", share=number(value))
