"""Which of many sets have much in common, found by what they share and not by comparing each two.

A fingerprint weighs `log2(1 + n / n_f)`: n sets, of which n_f have it (inverse document frequency;
Spärck Jones, A statistical interpretation of term specificity, 1972; smoothed, so that what all
have in common still weighs one bit). What many have written alike weighs little, what nobody else
has weighs most.

Equal sets are looked at once, however many there are. Fingerprints are followed from the rarest on;
those that so many have that following them would take more than `MOST_STEPS` steps weigh nothing.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
import numpy.typing as npt

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]

#: Pairs of sets with a fingerprint in common, each counted once a fingerprint.
MOST_STEPS: Final = 4_000_000


@dataclass(frozen=True)
class Pairs:
    """Pairs of sets that share enough, the first with the lower number.

    Attributes:
        first, second: numbers of sets, int64 (n,).
        count: how many fingerprints they share, int64 (n,).
        bits: what these weigh, float64 (n,).
        share: `bits` of what the lighter one weighs, float64 (n,), 0 to 1.
        share_of_both: `bits` of what the heavier one weighs, float64 (n,), 0 to 1.
    """

    first: Ints
    second: Ints
    count: Ints
    bits: Floats
    share: Floats
    share_of_both: Floats

    def where(self, mask: npt.NDArray[np.bool_]) -> Pairs:
        """Some of them."""
        return Pairs(
            *(self.first[mask], self.second[mask], self.count[mask], self.bits[mask]),
            *(self.share[mask], self.share_of_both[mask]),
        )


class Index:
    """Fingerprints and the sets that have them.

    Args:
        sets: of each hand-in its fingerprints; an empty one has nothing in common with anybody.
    """

    def __init__(self, sets: Sequence[Collection[int]]) -> None:
        self.size = len(sets)
        kinds: dict[tuple[int, ...], int] = {}
        keys = [tuple(sorted(set(each))) for each in sets]
        #: Of each set, which kind of set it is.
        self.kind: Ints = np.array([kinds.setdefault(key, len(kinds)) for key in keys], np.int64)
        #: How many sets are of a kind.
        self.many: Ints = np.bincount(self.kind, minlength=len(kinds)).astype(np.int64)
        lengths = [len(key) for key in kinds]
        self._owner: Ints = np.repeat(np.arange(len(kinds)), lengths)
        flat = np.array([value for key in kinds for value in key], np.int64)
        self._values, which = np.unique(flat, return_inverse=True)
        self._which: Ints = which.reshape(-1).astype(np.int64)
        self._has = np.bincount(self._which, self.many[self._owner], len(self._values))

    @property
    def pairs_in_all(self) -> int:
        """How many pairs of sets there are."""
        return self.size * (self.size - 1) // 2

    @cached_property
    def _kinds_with(self) -> Ints:
        """How many kinds have each fingerprint."""
        return np.bincount(self._which, minlength=len(self._values)).astype(np.int64)

    @cached_property
    def followed(self) -> npt.NDArray[np.bool_]:
        """Of each fingerprint, whether it is rare enough to be followed."""
        kinds = self._kinds_with
        order = np.argsort(kinds, kind="stable")
        steps = np.cumsum(kinds[order] * (kinds[order] - 1) // 2)
        enough = int(np.searchsorted(steps, MOST_STEPS, side="right"))
        too_common = kinds[order[enough]] if enough < len(order) else np.iinfo(np.int64).max
        return np.asarray(kinds < too_common)

    @cached_property
    def weight(self) -> Floats:
        """Of each fingerprint [bits]."""
        weights = np.log2(1.0 + self.size / np.maximum(self._has, 1))
        return np.where(self.followed, weights, 0.0)

    @cached_property
    def mass(self) -> Floats:
        """What each kind weighs [bits]."""
        return _sums(self._owner, self.weight[self._which], len(self.many))

    def has(self, fingerprint: int) -> int:
        """How many sets have a fingerprint."""
        at = int(np.searchsorted(self._values, fingerprint))
        found = at < len(self._values) and self._values[at] == fingerprint
        return int(self._has[at]) if found else 0

    def pairs(self, fewest: int) -> Pairs:
        """Pairs of *kinds* that share at least so many fingerprints, a kind with itself included.

        The pair of a kind with itself stands for all pairs of sets that are of it.
        """
        first, second, count, bits = self._met()
        enough = count >= fewest
        first, second, count, bits = first[enough], second[enough], count[enough], bits[enough]
        own = np.bincount(self._owner, self.followed[self._which], len(self.many)).astype(np.int64)
        equal = np.flatnonzero((self.many > 1) & (own >= fewest))
        first, second = np.concatenate((first, equal)), np.concatenate((second, equal))
        count = np.concatenate((count, own[equal]))
        bits = np.concatenate((bits, self.mass[equal]))
        masses = np.stack((self.mass[first], self.mass[second]))
        share, of_both = bits / masses.min(axis=0), bits / masses.max(axis=0)
        return Pairs(first, second, count, bits, share.round(6), of_both.round(6))

    def stands_for(self, pairs: Pairs) -> Ints:
        """How many pairs of sets each pair of kinds stands for."""
        a, b = self.many[pairs.first], self.many[pairs.second]
        return np.where(pairs.first == pairs.second, a * (a - 1) // 2, a * b)

    def _met(self) -> tuple[Ints, Ints, Ints, Floats]:
        """Pairs of kinds with a fingerprint in common, how many, and what they weigh."""
        order = np.argsort(self._which, kind="stable")
        owners, ends = self._owner[order], np.cumsum(self._kinds_with)
        keys: list[Ints] = [np.zeros(0, np.int64)]
        weights: list[Floats] = [np.zeros(0)]
        for many in np.unique(self._kinds_with[self.followed]).tolist():
            which = np.flatnonzero(self.followed & (self._kinds_with == many))
            if many < 2:
                continue
            rows = owners[(ends[which] - many)[:, None] + np.arange(many)]
            left, right = np.triu_indices(many, 1)
            keys.append((rows[:, left] * len(self.many) + rows[:, right]).ravel())
            weights.append(np.repeat(self.weight[which], len(left)))
        found, place = np.unique(np.concatenate(keys), return_inverse=True)
        place = place.reshape(-1)
        count = np.bincount(place, minlength=len(found)).astype(np.int64)
        bits = _sums(place, np.concatenate(weights), len(found))
        divisor = max(1, len(self.many))
        return found // divisor, found % divisor, count, bits


def _sums(places: Ints, weights: Floats, size: int) -> Floats:
    """The sum of the weights at each place."""
    return np.bincount(places, weights, size).astype(np.float64)


def at_least(values: Floats, weights: Ints, asked: Any) -> Ints:
    """How many, counted by weight, have at least each of the values that are asked for."""
    order = np.argsort(values, kind="stable")
    before = np.concatenate(([0], np.cumsum(weights[order])))
    at = np.searchsorted(values[order], asked, side="left")
    return np.asarray(before[-1] - before[at], dtype=np.int64)
