"""Find pairs of similar hand-ins in a class.

A pair is listed if its files are the same, and are not those that everybody was given; or if both
behave alike and nearly nobody else does. Right solutions behave alike: so behaviour counts only in
a class that is large enough to show what is usual, and only if it is unusual there.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, islice
from math import ceil
from typing import Final

import numpy as np
import numpy.typing as npt

from grader.batch.similar.features import Features, TimedCommand, hash_of

NEAR_MM: Final = 10
#: Behaviour counts in a class of at least so many, if two behave so, or at most one in so many.
LARGE_CLASS: Final = 30
ONE_IN: Final = 100
#: The longest list of pairs; the groups include the others.
MOST_PAIRS: Final = 2000
#: The length of a sequence of commands that is compared (an n-gram).
LENGTH: Final = 3
#: Two hand-ins are alike with so many common n-grams, and this share of the longer one's.
FEWEST: Final = 8
LEAST_SHARE: Final = 0.9
#: The n-grams of all commands of a hand-in, with the times between them.
Kind = frozenset[int]
_ROWS: Final = 256
Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Compared:
    """The features of a hand-in that are compared.

    Attributes:
        key: of its content; '' where there is none, or where everybody was given it.
        features: None where it is unknown: then only the content is compared.
    """

    key: str
    features: Features | None


@dataclass(frozen=True)
class Pair:
    """Two hand-ins, by their numbers, the lower one first.

    Attributes:
        same_content: whether their files are the same.
        commands_hands: how many hand-ins send such commands as one of the two, both included; 0:
            the commands of the two are not alike.
        path_mm: the mean distance of their paths; None where one has none.
        path_hands: how many paths are as near to one of the two, both included.
        equal_s: how long their commands are equal from the first one on [s].
        equal_commands: the share of equal commands, one by one, 0 to 1.
        group: the number of their group, from 1.
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
        """The sort key: the same files first, then what the fewest others do."""
        others = self.commands_hands or self.path_hands
        return (not self.same_content, others, -self.equal_commands, self.first, self.second)


@dataclass(frozen=True)
class Comparison:
    """The similar hand-ins of a class.

    Attributes:
        pairs: sorted by `Pair.order`.
        more: how many pairs are beyond the limit of `pairs`.
        groups: numbers of hand-ins that pairs connect; the index is a pair's `group` minus 1.
        is_large: whether the class is large enough for behaviour to count.
    """

    pairs: tuple[Pair, ...]
    more: int
    groups: tuple[tuple[int, ...], ...]
    is_large: bool


def compare(hand_ins: Sequence[Compared]) -> Comparison:
    """Find the similar hand-ins of a class."""
    found = [each.features or Features() for each in hand_ins]
    of_each = [each.commands for each in found]
    commands, paths = Commands(of_each), Paths([each.path for each in found])
    is_large = len(hand_ins) >= LARGE_CLASS
    contents = _equal_contents(hand_ins)

    def numbers() -> Iterator[tuple[int, int]]:
        for members in contents:
            yield from combinations(members, 2)
        if is_large:
            rare = max(2, len(hand_ins) // ONE_IN)  # what at most so many do is unusual
            yield from commands.pairs(rare)
            yield from paths.rarely_near(NEAR_MM, rare)

    every = dict.fromkeys(numbers())
    groups = _groups(every)
    of = {member: n for n, members in enumerate(groups, 1) for member in members}

    def pair(first: int, second: int) -> Pair:
        equal_s, equal_commands = equal(of_each[first], of_each[second])
        path_mm = paths.distance(first, second)
        return Pair(
            first,
            second,
            same_content=bool(hand_ins[first].key) and hand_ins[first].key == hand_ins[second].key,
            commands_hands=commands.hands(first, second),
            path_mm=path_mm,
            path_hands=0 if path_mm is None else paths.hands(first, second, path_mm),
            equal_s=equal_s,
            equal_commands=equal_commands,
            group=of[first],
        )

    listed = sorted((pair(*each) for each in islice(every, MOST_PAIRS)), key=lambda p: p.order)
    more = max(0, len(every) - MOST_PAIRS)
    return Comparison(tuple(listed), more, tuple(groups), is_large)


def _equal_contents(hand_ins: Sequence[Compared]) -> list[list[int]]:
    """Return the numbers of hand-ins with equal contents, in groups."""
    found: dict[str, list[int]] = defaultdict(list)
    for number, each in enumerate(hand_ins):
        if each.key:
            found[each.key].append(number)
    return [members for members in found.values() if len(members) > 1]


class Commands:
    """The commands of a class, by what is alike.

    Args:
        of_each: the commands of each hand-in.
    """

    def __init__(self, of_each: Sequence[Sequence[TimedCommand]]) -> None:
        self._kinds = [grams(each) for each in of_each]
        members: dict[Kind, list[int]] = defaultdict(list)
        for number, kind in enumerate(self._kinds):
            if len(kind) >= FEWEST:
                members[kind].append(number)
        self._members = members
        self._alike: dict[Kind, list[Kind]] = {kind: [kind] for kind in members}
        by_gram: dict[int, list[Kind]] = defaultdict(list)
        for one in sorted(members, key=len):
            fewest = max(FEWEST, ceil(LEAST_SHARE * len(one)))
            # two kinds with so many in common share one of these, too
            first = sorted(one)[: len(one) - fewest + 1]
            for other in dict.fromkeys(kind for gram in first for kind in by_gram[gram]):
                if len(one & other) >= fewest:
                    self._alike[one].append(other)
                    self._alike[other].append(one)
            for gram in first:
                by_gram[gram].append(one)

    def hands(self, first: int, second: int) -> int:
        """Return how many send such commands as one of two, both included; 0: not alike."""
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


def grams(commands: Sequence[TimedCommand]) -> Kind:
    """Return the n-grams of commands and the times between them: the start does not matter."""
    steps = [
        (str(each.time_ns - before.time_ns), str(each.hash))
        for before, each in zip((TimedCommand(0, 0), *commands), commands, strict=False)
    ]
    last = len(steps) - LENGTH + 1
    return frozenset(
        hash_of(word for step in steps[at : at + LENGTH] for word in step) for at in range(last)
    )


def equal(one: Sequence[TimedCommand], other: Sequence[TimedCommand]) -> tuple[float, float]:
    """Return how long commands are equal [s], and the share of equal ones, 0 to 1."""
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
    """The paths of a class.

    Args:
        ways: x, y of the points [mm] of each hand-in; empty where it has no path.
    """

    def __init__(self, ways: Sequence[Sequence[int]]) -> None:
        self._who = [number for number, way in enumerate(ways) if way]
        self._place = {number: row for row, number in enumerate(self._who)}
        # Whole numbers, and their products summed up are below 2**53: floats hold them exactly,
        # so the order of additions does not matter.
        longest = max(map(len, ways), default=0)
        flat = np.array([ways[number] for number in self._who], dtype=np.float64)
        self._points = flat.reshape(len(self._who), longest)
        self._squares = (self._points**2).sum(axis=1)

    def distance(self, first: int, second: int) -> int | None:
        """Return the mean distance of two paths [mm]; None where one hand-in has none."""
        if first not in self._place or second not in self._place:
            return None
        apart = self._points[self._place[first]] - self._points[self._place[second]]
        return int(self._mm(np.array([apart @ apart]))[0])

    def hands(self, first: int, second: int, within_mm: int) -> int:
        """Return how many paths are so near to one of the two, itself included; the greater one."""
        rows = np.array([self._place[first], self._place[second]])
        return int((self._distances(rows) <= within_mm).sum(axis=1).max())

    def rarely_near(self, within_mm: int, most: int) -> list[tuple[int, int]]:
        """Return the pairs so near to each other, where each has at most so many near it."""
        near: dict[int, list[int]] = {}
        for begin in range(0, len(self._who), _ROWS):
            rows = np.arange(begin, min(begin + _ROWS, len(self._who)))
            close = self._distances(rows) <= within_mm
            for row in np.flatnonzero(close.sum(axis=1) <= most).tolist():
                near[begin + row] = np.flatnonzero(close[row]).tolist()
        return [
            (self._who[row], self._who[other])
            for row, others in near.items()
            for other in others
            if row < other and other in near
        ]

    def _distances(self, rows: npt.NDArray[np.int_]) -> Floats:
        """Return the distances of some paths, by their rows, to all paths [mm]."""
        both = self._points[rows] @ self._points.T
        return self._mm(self._squares[rows][:, None] + self._squares - 2 * both)

    def _mm(self, squares: Floats) -> Floats:
        return np.floor(np.sqrt(squares / max(1, self._points.shape[1] // 2)))


def _groups(pairs: Iterable[tuple[int, int]]) -> list[tuple[int, ...]]:
    """Return the groups that pairs connect, sorted by their lowest numbers."""
    of: dict[int, list[int]] = {}
    for one, other in pairs:
        small, large = sorted((of.setdefault(n, [n]) for n in (one, other)), key=len)
        if small is not large:
            large += small
            of.update(dict.fromkeys(small, large))
    return sorted({tuple(sorted(members)) for members in of.values()})
