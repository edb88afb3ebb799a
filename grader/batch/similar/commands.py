"""The commands of the hand-ins of a class: who sends such as another does, and how many others."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import takewhile
from typing import Final

from grader.batch.similar.behaviour import Asked, hash_of

#: Commands that follow one another are looked at so many at once.
LENGTH: Final = 3
#: So many of these two have in common, and so much of all that the longer one has.
FEWEST: Final = 8
LEAST_SHARE: Final = 0.9

#: A kind of commands: all that are sent, by the time between them.
Kind = frozenset[int]


class Commands:
    """Whose commands are alike.

    Args:
        asked: of each hand-in.
    """

    def __init__(self, asked: Sequence[Sequence[Asked]]) -> None:
        self._kinds = [grams(each) for each in asked]
        members: dict[Kind, list[int]] = defaultdict(list)
        for number, kind in enumerate(self._kinds):
            if len(kind) >= FEWEST:
                members[kind].append(number)
        self._members = members
        self._alike: dict[Kind, list[Kind]] = {kind: [kind] for kind in members}
        by_length = sorted(members, key=len)
        for at, one in enumerate(by_length):
            for other in takewhile(partial(_may_be_alike, one), by_length[at + 1 :]):
                if are_alike(one, other):
                    self._alike[one].append(other)
                    self._alike[other].append(one)

    def hands(self, first: int, second: int) -> int:
        """How many send such commands as one of two that are alike, both among them; else 0."""
        one, other = self._kinds[first], self._kinds[second]
        if other not in self._alike.get(one, ()):
            return 0
        return max(self._hands(one), self._hands(other))

    def pairs(self, most_hands: int) -> Iterator[tuple[int, int]]:
        """Pairs that are alike, where so many or fewer are alike with one of them."""
        rare = {kind for kind in self._alike if self._hands(kind) <= most_hands}
        for one in rare:
            near = [n for kind in self._alike[one] if kind in rare for n in self._members[kind]]
            for first in self._members[one]:
                yield from ((first, second) for second in near if first < second)

    def _hands(self, kind: Kind) -> int:
        return sum(len(self._members[each]) for each in self._alike[kind])


def grams(asked: Sequence[Asked]) -> Kind:
    """Commands that follow one another, by the time between them: whenever they begin."""
    steps = [
        (str(each.tick - before.tick), str(each.hash))
        for before, each in zip((Asked(0, 0), *asked), asked, strict=False)
    ]
    last = len(steps) - LENGTH + 1
    return frozenset(
        hash_of(word for step in steps[at : at + LENGTH] for word in step) for at in range(last)
    )


def are_alike(one: Kind, other: Kind) -> bool:
    """Whether two kinds have nearly all in common."""
    return len(one & other) >= max(FEWEST, LEAST_SHARE * max(len(one), len(other)))


def _may_be_alike(short: Kind, long: Kind) -> bool:
    return len(short) >= LEAST_SHARE * len(long)


def equal(one: Sequence[Asked], other: Sequence[Asked]) -> tuple[int, float]:
    """For how many ticks commands are equal, and how much of them is, tick by tick, 0 to 1."""
    if not one or not other:
        return 0, 0.0
    pairs = zip(one, other, strict=False)
    different = next((min(a.tick, b.tick) for a, b in pairs if a != b), None)
    if different is None:
        rest = max(one, other, key=len)[min(len(one), len(other)) :]
        different = rest[0].tick if rest else one[-1].tick + 1
    both = (Counter(one) & Counter(other)).total()
    return different, round(both / max(len(one), len(other)), 4)
