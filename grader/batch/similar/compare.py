"""Which hand-ins of a class to look at together.

Two are listed where their files are the same, and are not what everybody was given; or where their
behaviour is alike and nearly nobody else's is. Right solutions behave alike: behaviour counts in a
class that is large enough to tell what is usual in it, and only as far as it is unusual there.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, islice
from typing import Final

from grader.batch.similar.behaviour import Behaved
from grader.batch.similar.commands import Commands, equal
from grader.batch.similar.groups import Groups
from grader.batch.similar.paths import Paths

NEAR_MM: Final = 10
#: Behaviour counts from so many hand-ins on, where two behave so, or one in so many.
LARGE_CLASS: Final = 30
ONE_IN: Final = 100
#: Pairs that are listed; of what is beyond, the groups tell.
MOST_PAIRS: Final = 2000


@dataclass(frozen=True)
class HandedIn:
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
        equal_ticks: their commands are equal for so many ticks from the first one on.
        equal_commands: so much of their commands is equal, tick by tick, 0 to 1.
        group: which group they are in, from 1.
    """

    first: int
    second: int
    same_content: bool = False
    commands_hands: int = 0
    path_mm: int | None = None
    path_hands: int = 0
    equal_ticks: int = 0
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


def compare(handed_in: Sequence[HandedIn]) -> Look:
    """Find what to look at together."""
    found = [each.behaved or Behaved() for each in handed_in]
    asked = [each.commands for each in found]
    commands, paths = Commands(asked), Paths([each.path for each in found])
    is_large = len(handed_in) >= LARGE_CLASS
    contents = _equal_contents(handed_in)
    groups = Groups(len(handed_in))
    for members in contents:
        for member in members[1:]:
            groups.join(members[0], member)

    def numbers() -> Iterator[tuple[int, int]]:
        for members in contents:
            yield from combinations(members, 2)
        if is_large:
            rare = max(2, len(handed_in) // ONE_IN)  # what so many do, or fewer, is unusual
            yield from commands.pairs(rare)
            yield from paths.rarely_near(NEAR_MM, rare)

    every = dict.fromkeys(numbers())
    for first, second in every:
        groups.join(first, second)
    of = {member: n for n, members in enumerate(groups.members(), 1) for member in members}

    def pair(first: int, second: int) -> Pair:
        equal_ticks, equal_commands = equal(asked[first], asked[second])
        path_mm = paths.distance(first, second)
        return Pair(
            first,
            second,
            same_content=bool(handed_in[first].key)
            and handed_in[first].key == handed_in[second].key,
            commands_hands=commands.hands(first, second),
            path_mm=path_mm,
            path_hands=0 if path_mm is None else paths.hands(first, second, path_mm),
            equal_ticks=equal_ticks,
            equal_commands=equal_commands,
            group=of[first],
        )

    listed = sorted((pair(*each) for each in islice(every, MOST_PAIRS)), key=lambda p: p.order)
    more = max(0, len(every) - MOST_PAIRS)
    return Look(tuple(listed), more, tuple(groups.members()), is_large)


def _equal_contents(handed_in: Sequence[HandedIn]) -> list[list[int]]:
    """Those that handed in the same."""
    found: dict[str, list[int]] = defaultdict(list)
    for number, each in enumerate(handed_in):
        if each.key:
            found[each.key].append(number)
    return [members for members in found.values() if len(members) > 1]
