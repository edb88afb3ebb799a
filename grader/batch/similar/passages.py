"""What two sources have in common, passage by passage, and their lines side by side."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from grader import text
from grader.batch.similar.index import Index
from grader.batch.similar.signature import Print, Signature
from grader.batch.similar.sources import File

#: Of a long source, so many lines are shown before and behind a passage.
CONTEXT: Final = 3
#: A source of so many lines is shown as a whole.
SHORT: Final = 400
MOST_LINES: Final = 1200
_LONGEST: Final = 200
_LINE_END: Final = re.compile("\r\n|\r|\n")  # as Python counts lines


@dataclass(frozen=True)
class Place:
    """Lines of a file, by its number, from first to last."""

    file: int
    first: int
    last: int

    def lines(self) -> set[tuple[int, int]]:
        """File and number of each."""
        last = min(self.last, self.first + MOST_LINES)
        return {(self.file, line) for line in range(self.first, last + 1)}

    def meets(self, other: Place) -> bool:
        """Whether they overlap, or follow one another."""
        return (
            self.file == other.file
            and self.first <= other.last + 1
            and other.first <= self.last + 1
        )

    def with_(self, other: Place) -> Place:
        """Both of them, which meet."""
        return replace(self, first=min(self.first, other.first), last=max(self.last, other.last))


@dataclass(frozen=True)
class Passage:
    """A passage that two sources have in common.

    Attributes:
        one, other: where it is in each.
        hands: how many hand-ins of the class have the rarest part of it; two at least.
    """

    one: Place
    other: Place
    hands: int


@dataclass(frozen=True)
class Line:
    """A line of a source.

    Attributes:
        number: its own; 0 stands for lines that are left out.
        text: fit to be shown.
        passage: which one it is in, from 1; 0: none.
        begins: whether it is the first line of it that is shown.
    """

    number: int
    text: str
    passage: int = 0
    begins: bool = False


def passages(
    one: Signature, other: Signature, known: frozenset[int], index: Index
) -> list[Passage]:
    """What they have in common, in the order of the first one."""
    places: dict[int, Print] = {}
    for each in other.prints:
        places.setdefault(each.hash, each)
    found: list[Passage] = []
    for each in sorted(set(one.prints), key=lambda p: (p.file, p.first, p.last, p.hash)):
        if each.hash in known or each.hash not in places:
            continue
        there = places[each.hash]
        new = Passage(_place(each), _place(there), max(2, index.has(each.hash)))
        last = found[-1] if found else None
        if last and last.one.meets(new.one) and last.other.meets(new.other):
            hands = min(last.hands, new.hands)
            found[-1] = Passage(last.one.with_(new.one), last.other.with_(new.other), hands)
        else:
            found.append(new)
    return _each_seen(found)


def _each_seen(found: list[Passage]) -> list[Passage]:
    """Those that have a line on either side which is in none before."""
    here: set[tuple[int, int]] = set()
    there: set[tuple[int, int]] = set()
    seen = []
    for each in found:
        one, other = each.one.lines(), each.other.lines()
        if one <= here or other <= there:
            continue
        here |= one
        there |= other
        seen.append(each)
    return seen


def lines(
    files: Sequence[str], kept: Iterable[File], places: Sequence[Place]
) -> Mapping[str, list[Line]]:
    """The sources of one hand-in, with what is in a passage marked.

    Args:
        files: names, in the order of the places' numbers.
        kept: what is in them.
        places: of the passages, in order.
    """
    texts = {file.name: _texts(file.data) for file in kept}
    whole = sum(map(len, texts.values())) <= SHORT
    shown: dict[str, list[Line]] = {}
    left = MOST_LINES
    for number, name in enumerate(files):
        inside = _inside([(n, p) for n, p in enumerate(places, 1) if p.file == number])
        every = [
            Line(n, line, *inside.get(n, (0, False)))
            for n, line in enumerate(texts.get(name, ()), 1)
        ]
        chosen = (every if whole else _near(every))[:left]
        left -= len(chosen)
        if chosen:
            shown[name] = chosen
    return shown


def _place(each: Print) -> Place:
    return Place(each.file, each.first, each.last)


def _inside(places: Sequence[tuple[int, Place]]) -> dict[int, tuple[int, bool]]:
    """Of each line, which passage it is in, of several the first, and whether it is its first."""
    found: dict[int, tuple[int, bool]] = {}
    for number, place in places:
        free = [line for _, line in sorted(place.lines()) if line not in found]
        found.update((line, (number, line == free[0])) for line in free)
    return found


def _near(every: list[Line]) -> list[Line]:
    """The lines of passages, and some round them."""
    wanted = {
        at
        for line in every
        if line.passage
        for at in range(line.number - CONTEXT, line.number + CONTEXT + 1)
    }
    found: list[Line] = []
    for line in every:
        if line.number in wanted:
            found.append(line)
        elif not found or found[-1].number:
            found.append(Line(0, ""))
    return found


def _texts(data: bytes) -> list[str]:
    """The lines of a file, fit to be shown."""
    decoded = data.decode("utf-8-sig", "replace")
    found = [_line(line) for line in _LINE_END.split(decoded)]
    return found[:-1] if found and not found[-1] else found


def _line(line: str) -> str:
    return text.clip(text.without_controls(line.expandtabs(4)), _LONGEST)
