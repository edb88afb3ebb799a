"""Which hand-ins of a class to look at together, and how often such a likeness occurs in it.

Two are listed where what remains of the sources, when all that was given is taken away, is alike
for the most part; where their content is the same; or where their behaviour is alike and nearly
nobody else's is. Right solutions behave alike: behaviour alone counts in a class that is large
enough to tell what is usual in it, and only as far as it is unusual there.

How likely coincidence is, the class itself tells: of all its pairs, so many are as similar or more.
Pairs in the same group as the one that is asked about are counted apart, for a passage that went
through ten hands makes 45 pairs and is no coincidence for that.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Final

from grader.batch.similar.commands import equal, grams
from grader.batch.similar.groups import Groups
from grader.batch.similar.index import Index
from grader.batch.similar.pair import HandedIn, Likeness, Look, Pair
from grader.batch.similar.paths import Paths
from grader.batch.similar.respect import Respect
from grader.batch.similar.signature import Signature

#: Of what the lighter of two sources weighs, so much is the same.
LEAST_SHARE: Final = 0.6
#: Fingerprints that two sources have in common; below, short programs meet by chance.
FEWEST_PRINTS: Final = 16
LEAST_COMMANDS_SHARE: Final = 0.9
FEWEST_COMMANDS: Final = 8
NEAR_MM: Final = 10
#: Behaviour alone counts from so many hand-ins on, where two behave so, or one in so many.
LARGE_CLASS: Final = 30
ONE_IN: Final = 100
#: Pairs that are listed; of what is beyond, the groups tell.
MOST_PAIRS: Final = 2000


def compare(handed_in: Sequence[HandedIn], known: frozenset[int] = frozenset()) -> Look:
    """Find what to look at together.

    Args:
        known: fingerprints of what everybody was given.
    """
    return _Comparison(handed_in, known).look()


class _Comparison:
    """What is known of a class while it is compared."""

    def __init__(self, handed_in: Sequence[HandedIn], known: frozenset[int]) -> None:
        self._handed_in = handed_in
        self._size = len(handed_in)
        signatures = [each.signature or Signature() for each in handed_in]
        self._asked = [signature.commands for signature in signatures]
        prints = [{each.hash for each in signature.prints} for signature in signatures]
        own = [each - known for each in prints]
        self._only_given = tuple(
            n for n in range(self._size) if prints[n] and not own[n] and _is_read(signatures[n])
        )
        self._not_compared = tuple(n for n in range(self._size) if not prints[n])
        self._is_large = self._size >= LARGE_CLASS
        self._paths = Paths([signature.path for signature in signatures])
        self._index = Index(own)
        self._source = Respect(self._index, FEWEST_PRINTS, LEAST_SHARE, of_both=False)
        behaviours = Index([grams(asked) for asked in self._asked])
        self._commands = Respect(behaviours, FEWEST_COMMANDS, LEAST_COMMANDS_SHARE, of_both=True)
        self._contents = self._equal_contents()

    def look(self) -> Look:
        numbers, more = self._listed()
        groups = self._groups(numbers)
        of = {member: n for n, members in enumerate(groups, 1) for member in members}
        inside = self._inside(of)
        pairs = [self._pair(first, second, of[first], inside) for first, second in numbers]
        pairs.sort(key=lambda pair: pair.order)
        return Look(
            self._size * (self._size - 1) // 2,
            tuple(pairs),
            more,
            tuple(groups),
            self._only_given,
            self._not_compared,
            self._index,
            self._is_large,
        )

    # Which -----------------------------------------------------------------------------------

    def _listed(self) -> tuple[list[tuple[int, int]], int]:
        """The pairs to look at, and how many there are beside."""
        listed: dict[tuple[int, int], None] = {}
        everything = int(self._source.stands_for.sum())
        for pairs in (self._pairs_of_contents(), self._source.pairs(), iter(self._by_behaviour())):
            for pair in pairs:
                if len(listed) >= MOST_PAIRS:
                    break
                listed[pair] = None
        return list(listed), max(0, everything - len(listed))

    def _equal_contents(self) -> list[list[int]]:
        """Those that handed in the same, unless it is what was given."""
        found: dict[str, list[int]] = defaultdict(list)
        given = set(self._only_given)
        for number, each in enumerate(self._handed_in):
            if each.key and number not in given:
                found[each.key].append(number)
        return [members for members in found.values() if len(members) > 1]

    def _pairs_of_contents(self) -> Iterator[tuple[int, int]]:
        for members in self._contents:
            yield from combinations(members, 2)

    @property
    def _rare(self) -> int:
        """A behaviour that so many have, or fewer, is unusual."""
        return max(2, self._size // ONE_IN)

    def _by_behaviour(self) -> list[tuple[int, int]]:
        """Pairs whose behaviour is alike, and nearly nobody else's."""
        if not self._is_large:
            return []
        by_path = self._paths.rarely_near(NEAR_MM, self._rare)
        return [*self._commands.pairs(self._rare), *by_path]

    def _groups(self, listed: Sequence[tuple[int, int]]) -> list[tuple[int, ...]]:
        groups = Groups(self._size)
        for first, second in listed:
            groups.join(first, second)
        for members in self._contents:
            for member in members[1:]:
                groups.join(members[0], member)
        source = self._source
        for first, second in source.rows:
            for member in (*source.members[first], *source.members[second]):
                groups.join(source.members[first][0], member)
        return groups.members()

    # How likely ------------------------------------------------------------------------------

    def _inside(self, of: dict[int, int]) -> dict[int, list[int]]:
        """The rows of alike sources in each group."""
        rows: dict[int, list[int]] = defaultdict(list)
        for (first, _), row in self._source.rows.items():
            rows[of[self._source.members[first][0]]].append(row)
        return rows

    def _pair(self, first: int, second: int, group: int, inside: dict[int, list[int]]) -> Pair:
        one, other = self._handed_in[first], self._handed_in[second]
        equal_ticks, equal_commands = equal(self._asked[first], self._asked[second])
        path_mm = self._paths.distance(first, second)
        return Pair(
            first,
            second,
            same_content=bool(one.key) and one.key == other.key,
            source=self._source_likeness(first, second, inside[group]),
            commands=self._commands.likeness(first, second),
            path_mm=path_mm,
            path_hands=0 if path_mm is None else self._paths.hands(first, second, path_mm),
            equal_ticks=equal_ticks,
            equal_commands=equal_commands,
            group=group,
        )

    def _source_likeness(self, first: int, second: int, inside: list[int]) -> Likeness | None:
        source = self._source
        like, row = source.likeness(first, second), source.of(first, second)
        if like is None or row is None:
            return None
        as_similar = source.share[inside] >= source.share[row]
        of_group = int(source.stands_for[inside][as_similar].sum())
        return replace(like, outside=like.pairs - of_group)


def _is_read(signature: Signature) -> bool:
    """Whether all of its files could be read."""
    return not any(file.problem for file in signature.files)
