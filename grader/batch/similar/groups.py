"""Groups of hand-ins that pairs connect."""

from __future__ import annotations

from collections import defaultdict


class Groups:
    """Who is connected with whom.

    Args:
        size: how many there are; their numbers begin with 0.
    """

    def __init__(self, size: int) -> None:
        self._above = list(range(size))

    def top(self, member: int) -> int:
        """What stands for the group of somebody: its lowest number."""
        while self._above[member] != member:
            self._above[member] = self._above[self._above[member]]
            member = self._above[member]
        return member

    def join(self, one: int, other: int) -> None:
        """Connect two."""
        low, high = sorted((self.top(one), self.top(other)))
        self._above[high] = low

    def members(self) -> list[tuple[int, ...]]:
        """The groups of two and more, by their lowest numbers."""
        found: dict[int, list[int]] = defaultdict(list)
        for member in range(len(self._above)):
            found[self.top(member)].append(member)
        return [tuple(each) for each in found.values() if len(each) > 1]
