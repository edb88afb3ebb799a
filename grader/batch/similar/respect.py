"""A respect in which hand-ins are alike, source or commands: who, how much, how many others."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from itertools import combinations

import numpy as np

from grader.batch.similar.index import Index, Ints, at_least
from grader.batch.similar.pair import Likeness


class Respect:
    """Sets of fingerprints, and which of them are alike.

    Args:
        index: of the sets.
        fewest: fingerprints that two have in common.
        least: share that they have in common, 0 to 1.
        of_both: of what the heavier one weighs, too, not only of the lighter one.
    """

    def __init__(self, index: Index, fewest: int, least: float, of_both: bool) -> None:
        self._index = index
        found = index.pairs(fewest)
        shares = found.share_of_both if of_both else found.share
        self._found = found.where(shares >= least)
        #: Of each row, which is a pair of kinds of sets, what decides.
        self.share = shares[shares >= least]
        #: How many pairs of sets it stands for.
        self.stands_for = index.stands_for(self._found)
        #: Of each kind the numbers of the sets.
        self.members: dict[int, list[int]] = defaultdict(list)
        for number, kind in enumerate(index.kind.tolist()):
            self.members[kind].append(number)
        kinds = zip(self._found.first.tolist(), self._found.second.tolist(), strict=True)
        #: Of each pair of kinds its row.
        self.rows = {pair: row for row, pair in enumerate(kinds)}
        self._pairs = at_least(self.share, self.stands_for, self.share)
        of_kind = self._hands()
        self._row_hands = np.maximum(of_kind[self._found.first], of_kind[self._found.second])

    def _hands(self) -> Ints:
        """Of each kind, how many sets are alike with it, its own among them."""
        many, size = self._index.many, len(self._index.many)
        differ = self._found.first != self._found.second
        first, second = self._found.first[differ], self._found.second[differ]
        others = np.bincount(first, many[second], size) + np.bincount(second, many[first], size)
        return np.asarray(many + others, dtype=np.int64)

    def of(self, first: int, second: int) -> int | None:
        """The row of a pair of sets; None where they are not alike."""
        low, high = sorted((int(self._index.kind[first]), int(self._index.kind[second])))
        return self.rows.get((low, high))

    def likeness(self, first: int, second: int) -> Likeness | None:
        """How alike two sets are; None where they are not."""
        row = self.of(first, second)
        if row is None:
            return None
        return Likeness(
            float(self._found.share[row]),
            float(self._found.share_of_both[row]),
            int(self._found.count[row]),
            round(float(self._found.bits[row]), 1),
            pairs=int(self._pairs[row]),
            hands=int(self._row_hands[row]),
        )

    def pairs(self, most_hands: int | None = None) -> Iterator[tuple[int, int]]:
        """All pairs of sets, those of the heaviest first.

        Args:
            most_hands: only where so many are alike with one of them, both among them.
        """
        for row in np.argsort(-self._found.bits, kind="stable").tolist():
            if most_hands is not None and self._row_hands[row] > most_hands:
                continue
            first, second = int(self._found.first[row]), int(self._found.second[row])
            if first == second:
                yield from combinations(self.members[first], 2)
            else:
                for a in self.members[first]:
                    yield from ((min(a, b), max(a, b)) for b in self.members[second])
