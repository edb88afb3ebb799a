"""Which hand-ins of a class to look at together.

Two are listed where their files are the same, and are not what everybody was given; or where their
behaviour is alike and nearly nobody else's is. Right solutions behave alike: behaviour counts in a
class that is large enough to tell what is usual in it, and only as far as it is unusual there.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations, islice, takewhile
from typing import Final

import numpy as np
import numpy.typing as npt

from grader.batch.similar.behaviour import Asked, Behaved, hash_of

NEAR_MM: Final = 10
#: Behaviour counts from so many hand-ins on, where two behave so, or one in so many.
LARGE_CLASS: Final = 30
ONE_IN: Final = 100
#: Pairs that are listed; of what is beyond, the groups tell.
MOST_PAIRS: Final = 2000
#: Commands that follow one another are looked at so many at once.
LENGTH: Final = 3
#: So many of these two have in common, and so much of all that the longer one has.
FEWEST: Final = 8
LEAST_SHARE: Final = 0.9
#: A kind of commands: all that are sent, by the time between them.
Kind = frozenset[int]
_ROWS: Final = 256
Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Compared:
    """What is compared of a hand-in.

    Attributes:
        key: of its content; '' where there is none, or where it is what everybody was given.
        behaved: None where nothing is known of it: it is compared by its content only.
    """

    key: str
    behaved: Behaved | None


@dataclass(frozen=True)
class Pair:
    """Two hand-ins, by their numbers, the lower one first.

    Attributes:
        same_content: they have handed in the same.
        commands_hands: so many hand-ins send such commands as one of the two, both among them; 0:
            theirs are not alike.
        path_mm: how far apart their ways are; None where one went nowhere.
        path_hands: so many hand-ins went as near one of the two, both among them.
        equal_s: their commands are equal for so long from the first one on [s].
        equal_commands: so much of their commands is equal, one by one, 0 to 1.
        group: which group they are in, from 1.
    """

    first: int
    second: int
    same_content: bool = False
    commands_hands: int = 0
    path_mm: int | None = None
    path_hands: int = 0
    equal_s: float = 0.0
    equal_commands: float = 0.0
    group: int = 0

    @property
    def order(self) -> tuple[float, ...]:
        """The least likely ones come first: the same files, then what the fewest others do."""
        others = self.commands_hands or self.path_hands
        return (not self.same_content, others, -self.equal_commands, self.first, self.second)


@dataclass(frozen=True)
class Look:
    """A class, looked at together.

    Attributes:
        pairs: those to look at, the least likely ones first.
        more: how many of them are not in `pairs`, which has a limit.
        groups: numbers of hand-ins that pairs connect, the pairs' `group` minus 1.
        is_large: whether behaviour counts.
    """

    pairs: tuple[Pair, ...]
    more: int
    groups: tuple[tuple[int, ...], ...]
    is_large: bool


def compare(handed_in: Sequence[Compared]) -> Look:
    """Find what to look at together."""
    found = [each.behaved or Behaved() for each in handed_in]
    asked = [each.commands for each in found]
    commands, paths = Commands(asked), Paths([each.path for each in found])
    is_large = len(handed_in) >= LARGE_CLASS
    contents = _equal_contents(handed_in)

    def numbers() -> Iterator[tuple[int, int]]:
        for members in contents:
            yield from combinations(members, 2)
        if is_large:
            rare = max(2, len(handed_in) // ONE_IN)  # what so many do, or fewer, is unusual
            yield from commands.pairs(rare)
            yield from paths.rarely_near(NEAR_MM, rare)

    every = dict.fromkeys(numbers())
    groups = _groups(every)
    of = {member: n for n, members in enumerate(groups, 1) for member in members}

    def pair(first: int, second: int) -> Pair:
        equal_s, equal_commands = equal(asked[first], asked[second])
        path_mm = paths.distance(first, second)
        return Pair(
            first,
            second,
            same_content=bool(handed_in[first].key)
            and handed_in[first].key == handed_in[second].key,
            commands_hands=commands.hands(first, second),
            path_mm=path_mm,
            path_hands=0 if path_mm is None else paths.hands(first, second, path_mm),
            equal_s=equal_s,
            equal_commands=equal_commands,
            group=of[first],
        )

    listed = sorted((pair(*each) for each in islice(every, MOST_PAIRS)), key=lambda p: p.order)
    more = max(0, len(every) - MOST_PAIRS)
    return Look(tuple(listed), more, tuple(groups), is_large)


def _equal_contents(handed_in: Sequence[Compared]) -> list[list[int]]:
    """Those that handed in the same."""
    found: dict[str, list[int]] = defaultdict(list)
    for number, each in enumerate(handed_in):
        if each.key:
            found[each.key].append(number)
    return [members for members in found.values() if len(members) > 1]


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
        (str(each.time_ns - before.time_ns), str(each.hash))
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


def equal(one: Sequence[Asked], other: Sequence[Asked]) -> tuple[float, float]:
    """For how long commands are equal [s], and how much of them is, 0 to 1."""
    if not one or not other:
        return 0.0, 0.0
    pairs = zip(one, other, strict=False)
    different = next((min(a.time_ns, b.time_ns) for a, b in pairs if a != b), None)
    if different is None:
        rest = max(one, other, key=len)[min(len(one), len(other)) :]
        different = rest[0].time_ns if rest else one[-1].time_ns
    both = (Counter(one) & Counter(other)).total()
    return different / 1e9, round(both / max(len(one), len(other)), 4)


class Paths:
    """The ways of a class.

    Args:
        ways: of each hand-in x, y of its points [mm]; empty where it went nowhere.
    """

    def __init__(self, ways: Sequence[Sequence[int]]) -> None:
        self._who = [number for number, way in enumerate(ways) if way]
        self._place = {number: row for row, number in enumerate(self._who)}
        # Whole numbers, and their products summed up are below 2**53: floats hold them exactly,
        # so the same comes out however a machine adds them up.
        longest = max(map(len, ways), default=0)
        flat = np.array([ways[number] for number in self._who], dtype=np.float64)
        self._points = flat.reshape(len(self._who), longest)

    def distance(self, first: int, second: int) -> int | None:
        """How far two hand-ins are apart [mm]; None where one of them went nowhere."""
        if first not in self._place or second not in self._place:
            return None
        apart = self._points[self._place[first]] - self._points[self._place[second]]
        return int(self._mm(np.array([apart @ apart]))[0])

    def hands(self, first: int, second: int, within_mm: int) -> int:
        """How many hand-ins are so near one of the two, itself among them; of both the greater."""
        rows = [self._place[first], self._place[second]]
        return int((self._distances(self._points[rows]) <= within_mm).sum(axis=1).max())

    def rarely_near(self, within_mm: int, most: int) -> list[tuple[int, int]]:
        """Pairs that are so near each other, where each has so many so near it, or fewer."""
        near: dict[int, list[int]] = {}
        for begin in range(0, len(self._who), _ROWS):
            close = self._distances(self._points[begin : begin + _ROWS]) <= within_mm
            for row in np.flatnonzero(close.sum(axis=1) <= most).tolist():
                near[begin + row] = np.flatnonzero(close[row]).tolist()
        return [
            (self._who[row], self._who[other])
            for row, others in near.items()
            for other in others
            if row < other and other in near
        ]

    def _distances(self, rows: Floats) -> Floats:
        """Of some ways to all of them [mm]."""
        squares = (self._points**2).sum(axis=1)
        apart = (rows**2).sum(axis=1)[:, None] + squares - 2 * (rows @ self._points.T)
        return self._mm(apart)

    def _mm(self, squares: Floats) -> Floats:
        return np.floor(np.sqrt(squares / max(1, self._points.shape[1] // 2)))


def _groups(pairs: Iterable[tuple[int, int]]) -> list[tuple[int, ...]]:
    """Those whom pairs connect, by their lowest numbers."""
    of: dict[int, list[int]] = {}
    for one, other in pairs:
        small, large = sorted((of.setdefault(n, [n]) for n in (one, other)), key=len)
        if small is not large:
            large += small
            of.update(dict.fromkeys(small, large))
    return sorted({tuple(sorted(members)) for members in of.values()})
