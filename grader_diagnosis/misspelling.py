"""Tells a misspelt name."""

from __future__ import annotations

from difflib import SequenceMatcher

#: So alike two names have to be, 0 to 1, for one to be a misspelling of the other.
_ALIKE = 0.85
#: Words of a name that are shorter are no misspellings of each other: last_x, last_y.
_SHORT = 3


def misspelt(name: str, other: str) -> bool:
    """Whether one name is a misspelling of the other."""
    one, two = name.lower().split("_"), other.lower().split("_")
    if "".join(one) == "".join(two):
        return True
    if any(c.isdigit() for c in name + other):
        return False
    if len(one) == len(two):
        others = [pair for pair in zip(one, two, strict=True) if pair[0] != pair[1]]
        if any(min(map(len, pair)) < _SHORT for pair in others):
            return False
    alike = SequenceMatcher(None, name, other)  # the first two take little time, and are as sure
    return min(alike.real_quick_ratio(), alike.quick_ratio()) >= _ALIKE and alike.ratio() >= _ALIKE
