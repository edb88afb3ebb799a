"""The commands of two hand-ins: what is compared of them, and how far they are equal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Final

from grader.batch.similar.fingerprints import hash_of
from grader.batch.similar.signature import Asked

#: Commands that follow one another are looked at so many at once.
LENGTH: Final = 3


def grams(asked: Sequence[Asked]) -> set[int]:
    """Commands that follow one another, by the time between them: whenever they begin."""
    steps = [
        (str(each.tick - before.tick), str(each.hash))
        for before, each in zip((Asked(0, 0), *asked), asked, strict=False)
    ]
    last = len(steps) - LENGTH + 1
    return {
        hash_of(word for step in steps[at : at + LENGTH] for word in step) for at in range(last)
    }


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
