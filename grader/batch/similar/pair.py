"""What comes out of a comparison: pairs of hand-ins, in which respects they are alike, groups."""

from __future__ import annotations

from dataclasses import dataclass

from grader.batch.similar.index import Index
from grader.batch.similar.signature import Signature


@dataclass(frozen=True)
class HandedIn:
    """What is compared of a hand-in.

    Attributes:
        key: of its content; '' where there is none.
        signature: None where there is none: it is compared by its content only.
    """

    key: str
    signature: Signature | None


@dataclass(frozen=True)
class Likeness:
    """How alike two are in one respect, and of how many pairs of the class they are so, or more.

    Attributes:
        share: of the lighter one, 0 to 1.
        share_of_both: of the heavier one.
        count: what they share.
        bits: what that weighs; see `grader.batch.similar.index`.
        pairs: so many pairs of the class are as similar, this one among them.
        outside: as many of these as are not in its group.
        hands: so many hand-ins are alike with one of the two, both among them.
    """

    share: float
    share_of_both: float
    count: int
    bits: float
    pairs: int
    outside: int = 0
    hands: int = 0


@dataclass(frozen=True)
class Pair:
    """Two hand-ins, by their numbers, the lower one first.

    Attributes:
        same_content: they have handed in the same.
        source, commands: in which respect they are alike; None: in this one they are not.
        path_mm: how far apart their ways are; None where one went nowhere.
        path_hands: so many hand-ins went as near one of the two, both among them.
        equal_ticks: their commands are equal for so many ticks from the first one on.
        equal_commands: so much of their commands is equal, tick by tick, 0 to 1.
        group: which group they are in, from 1.
    """

    first: int
    second: int
    same_content: bool = False
    source: Likeness | None = None
    commands: Likeness | None = None
    path_mm: int | None = None
    path_hands: int = 0
    equal_ticks: int = 0
    equal_commands: float = 0.0
    group: int = 0

    @property
    def outside(self) -> int:
        """What there is of the same kind beside them: pairs by source, else hand-ins."""
        if self.source is not None:
            return self.source.outside
        return max(0, (self.commands.hands if self.commands else self.path_hands) - 2)

    @property
    def order(self) -> tuple[float, ...]:
        """The least likely ones come first: alike by source, with nothing like it elsewhere."""
        bits = sum(each.bits for each in (self.source, self.commands) if each)
        is_source = self.source is not None or self.same_content
        return (not is_source, self.outside, -round(bits, 3), self.first, self.second)


@dataclass(frozen=True)
class Look:
    """A class, looked at together.

    Attributes:
        pairs_in_all: how many pairs there are.
        pairs: those to look at, the least likely ones first.
        more: how many of them are not in `pairs`, which has a limit.
        groups: numbers of hand-ins that pairs connect, the pairs' `group` minus 1.
        only_given: numbers of those in whose sources nothing is but what was given.
        not_compared: numbers of those without sources that could be read.
        source_index: which fingerprint occurs in how many.
        is_large: whether behaviour alone counts.
    """

    pairs_in_all: int
    pairs: tuple[Pair, ...]
    more: int
    groups: tuple[tuple[int, ...], ...]
    only_given: tuple[int, ...]
    not_compared: tuple[int, ...]
    source_index: Index
    is_large: bool
